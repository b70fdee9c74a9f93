#include "formats/rows.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace mocapress {

RowStop read_numbers(std::string_view text, std::uint64_t begin, bool free, Row& row) {
  Scanner scanner{text, static_cast<std::size_t>(begin)};
  scanner.skip_blanks();
  if (scanner.ended()) return {RowEnd::end_of_data, begin, scanner.at};
  for (std::size_t c = 0; c < row.values.size(); ++c) {
    scanner.skip_blanks();
    while (free && !scanner.ended() && is_line_end(scanner.next())) {
      scanner.line_end();
      scanner.skip_blanks();
    }
    if (!scanner.number(row.values[c], row.shapes[c]))
      return {RowEnd::number_expected, begin, scanner.at};
  }
  if (!scanner.line_end() && !free) return {RowEnd::line_end_expected, begin, scanner.at};
  return {RowEnd::whole, begin, scanner.at};
}

Body read_rows(std::string_view text, std::uint64_t begin, std::size_t columns) {
  Body body(columns);
  Row row(columns);
  Scanner scanner{text, static_cast<std::size_t>(begin)};
  scanner.skip_empty_lines();
  while (columns > 0) {
    const RowStop stop = read_numbers(text, scanner.at, false, row);
    if (stop.end != RowEnd::whole) break;
    append_row(body, row, scanner.at, false);
    scanner.at = stop.next;
  }
  body.offsets.push_back(scanner.at);
  return body;
}

namespace {

// Room for a number and its padding.
using SlotBuffer = char[kLongestNumber + 256];

// Prints a number as it stands in its slot; gives the end.
char* print_slot(char* out, double value, const NumberFormat& format, std::uint8_t width) {
  char* end = print_number(out, value, format);
  const auto length = static_cast<std::size_t>(end - out);
  const bool sign = *out == '-' || *out == '+';
  if (width == kBlankSign && sign) return end;
  const std::size_t wanted = width == kBlankSign ? length + 1 : width % kBlankSign;
  if (wanted <= length) return end;
  const std::size_t padding = wanted - length;
  if (width > kBlankSign) return std::fill_n(end, padding, ' ');
  char* const from = format.zeros && sign ? out + 1 : out;
  std::memmove(from + padding, from, static_cast<std::size_t>(end - from));
  std::fill_n(from, padding, format.zeros && width != kBlankSign ? '0' : ' ');
  return end + padding;
}

char* print_counter(char* out, std::int64_t counter, std::uint8_t width) {
  char* const end = std::to_chars(out, out + 24, counter).ptr;
  char* const from = counter < 0 ? out + 1 : out;
  const auto length = static_cast<std::size_t>(end - out);
  if (width <= length) return end;
  std::memmove(from + width - length, from, static_cast<std::size_t>(end - from));
  std::fill_n(from, width - length, '0');
  return out + width;
}

}  // namespace

void print_row(std::string& out, const RowTemplate& row, const double* values, std::int64_t counter,
               const NumberFormat* formats, const std::vector<SlotText>& replaced) {
  SlotBuffer text;
  const std::string* literal = row.literals.data();
  if (row.counter) {
    out += *literal++;
    out.append(text, print_counter(text, counter, row.counter_width));
  }
  auto next = replaced.begin();
  for (std::uint32_t k = 0; k < row.columns.size(); ++k) {
    out += *literal++;
    if (next != replaced.end() && next->slot == k) {
      out += next++->text;
      continue;
    }
    const std::uint32_t column = row.columns[k];
    out.append(text, print_slot(text, values[column], formats[column], row.widths[k]));
  }
  out += *literal;
}

bool match_row(std::string_view bytes, const RowTemplate& row, const double* values,
               std::int64_t counter, const NumberFormat* formats,
               std::vector<SlotText>& differing) {
  differing.clear();
  SlotBuffer text;
  const char* p = bytes.data();
  const char* const end = p + bytes.size();
  const auto take = [&](const char* expected, std::size_t length) {
    if (static_cast<std::size_t>(end - p) < length || std::memcmp(p, expected, length) != 0)
      return false;
    p += length;
    return true;
  };
  const std::string* literal = row.literals.data();
  if (row.counter) {
    if (!take(literal->data(), literal->size())) return false;
    ++literal;
    const char* const last = print_counter(text, counter, row.counter_width);
    if (!take(text, static_cast<std::size_t>(last - text))) return false;
  }
  for (std::size_t k = 0; k < row.columns.size(); ++k) {
    if (!take(literal->data(), literal->size())) return false;
    ++literal;
    const std::uint32_t column = row.columns[k];
    const std::uint8_t width = row.widths[k];
    const char* const last = print_slot(text, values[column], formats[column], width);
    const char* const start = p;
    if (take(text, static_cast<std::size_t>(last - text)) &&
        (p == end || is_space(*p) || last[-1] == ' '))
      continue;
    // Another text for the number: up to the next blank, and with its padding where there is one.
    p = start;
    if (width > 0 && width <= kBlankSign)
      while (p < end && *p == ' ') ++p;
    while (p < end && !is_space(*p)) ++p;
    if (width > kBlankSign)
      while (p < end && *p == ' ' && p - start < width - kBlankSign) ++p;
    if (p == start) return false;
    differing.push_back(
        {static_cast<std::uint32_t>(k), {start, static_cast<std::size_t>(p - start)}});
  }
  return take(literal->data(), literal->size()) && p == end;
}

}  // namespace mocapress
