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

void print_row(std::string& out, const RowTemplate& row, const double* values, std::int64_t counter,
               const NumberFormat* formats, const std::vector<SlotText>& replaced) {
  char text[kLongestNumber];
  const std::string* literal = row.literals.data();
  if (row.counter) {
    out += *literal++;
    out.append(text, std::to_chars(text, text + sizeof text, counter).ptr);
  }
  auto next = replaced.begin();
  for (std::uint32_t k = 0; k < row.columns.size(); ++k) {
    out += *literal++;
    if (next != replaced.end() && next->slot == k) {
      out += next++->text;
      continue;
    }
    const std::uint32_t column = row.columns[k];
    const char* const end = print_number(text, values[column], formats[column]);
    const auto length = static_cast<std::size_t>(end - text);
    if (row.widths[k] > length) out.append(row.widths[k] - length, ' ');
    out.append(text, length);
  }
  out += *literal;
}

bool match_row(std::string_view bytes, const RowTemplate& row, const double* values,
               std::int64_t counter, const NumberFormat* formats,
               std::vector<SlotText>& differing) {
  differing.clear();
  char text[kLongestNumber];
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
    const auto length =
        static_cast<std::size_t>(std::to_chars(text, text + sizeof text, counter).ptr - text);
    if (!take(text, length)) return false;
  }
  for (std::size_t k = 0; k < row.columns.size(); ++k) {
    if (!take(literal->data(), literal->size())) return false;
    ++literal;
    const std::uint32_t column = row.columns[k];
    const auto length =
        static_cast<std::size_t>(print_number(text, values[column], formats[column]) - text);
    const std::size_t padding = row.widths[k] > length ? row.widths[k] - length : 0;
    const char* const start = p;
    for (std::size_t i = 0; i < padding && p < end && *p == ' '; ++i) ++p;
    const bool padded = static_cast<std::size_t>(p - start) == padding;
    if (padded && take(text, length) && (p == end || is_space(*p))) continue;
    // Another text for the number: up to the next blank, and with its padding where there is one.
    p = start;
    if (row.widths[k] > 0)
      while (p < end && *p == ' ') ++p;
    while (p < end && !is_space(*p)) ++p;
    if (p == start) return false;
    differing.push_back(
        {static_cast<std::uint32_t>(k), {start, static_cast<std::size_t>(p - start)}});
  }
  return take(literal->data(), literal->size()) && p == end;
}

}  // namespace mocapress
