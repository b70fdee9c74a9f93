#include "formats/rows.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <numeric>

namespace mocapress {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// Whether a line that begins so is none of the frame before: it is the next frame's number, or the
// NULs or the Ctrl-Z that some programs leave behind a text.
bool may_follow_row(char c) { return is_digit(c) || c == '-' || c == '\0' || c == '\x1a'; }

// A position in the text that moves by items.
struct Cursor {
  const char* p;
  const char* end;

  void skip_blanks() {
    while (p < end && is_blank(*p)) ++p;
  }
  // True at the end of a line, which it passes together with empty lines and comments behind it.
  bool line_end() {
    skip_blanks();
    if (p == end) return true;
    if (*p != '\n') return false;
    ++p;
    skip_empty_lines();
    return true;
  }
  void skip_empty_lines() {
    for (const char* q = p; q < end;) {
      while (q < end && is_blank(*q)) ++q;
      if (q < end && *q == '#')
        while (q < end && *q != '\n') ++q;
      if (q == end) p = end;
      if (q == end || *q != '\n') return;
      p = ++q;
    }
  }
  bool word(const std::string& expected) {
    skip_blanks();
    const std::size_t length = expected.size();
    if (static_cast<std::size_t>(end - p) < length || std::memcmp(p, expected.data(), length) != 0)
      return false;
    if (p + length < end && !is_blank(p[length]) && p[length] != '\n') return false;
    p += length;
    return true;
  }
  bool counter(std::int64_t& value) {
    skip_blanks();
    const auto [rest, error] = std::from_chars(p, end, value);
    if (error != std::errc{}) return false;
    p = rest;
    return true;
  }
  bool number(double& value, NumberShape& shape) {
    skip_blanks();
    const char* const rest = parse_number(p, end, value, shape);
    if (rest == nullptr || (rest < end && !is_blank(*rest) && *rest != '\n')) return false;
    p = rest;
    return true;
  }
};

void note(ColumnStatistics& column, const NumberShape& shape) {
  if (shape.exponent_digits > 0) {
    column.exponent_digits = column.exponent_digits == 0
                                 ? shape.exponent_digits
                                 : std::min(column.exponent_digits, shape.exponent_digits);
  } else {
    column.least_decimals = std::min(column.least_decimals, shape.decimals);
    column.most_decimals = std::max(column.most_decimals, shape.decimals);
  }
  column.most_significant = std::max(column.most_significant, shape.significant);
  column.trailing_zero |= shape.trailing_zero;
  column.whole_without_point |= !shape.point;
  column.bare_point |= shape.bare_point;
  column.upper |= shape.upper;
}

}  // namespace

std::size_t RowShape::columns() const {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

ParsedRows parse_rows(std::string_view data, std::uint64_t begin, const RowShape& shape,
                      std::uint64_t most_rows) {
  ParsedRows parsed;
  const std::size_t columns = shape.columns();
  parsed.statistics.resize(columns);
  Cursor cursor{data.data() + begin, data.data() + data.size()};
  const auto offset = [&](const char* p) { return static_cast<std::uint64_t>(p - data.data()); };
  cursor.skip_empty_lines();
  std::vector<double> row(columns);
  std::vector<NumberShape> shapes(columns);
  while (true) {
    const char* const start = cursor.p;
    Cursor next = cursor;
    next.skip_blanks();
    RowEnd end = RowEnd::end_of_data;
    std::uint32_t item = 0;
    std::int64_t counter = 0;
    bool whole = next.p < next.end;
    const auto stop = [&](RowEnd why) {
      end = why;
      whole = false;
    };
    if (whole && parsed.offsets.size() == most_rows) stop(RowEnd::limit);
    if (whole && shape.counter) {
      if (!next.counter(counter)) {
        stop(RowEnd::number_expected);
      } else if (!next.line_end()) {
        stop(RowEnd::line_end_expected);
      }
    }
    std::size_t column = 0;
    for (std::size_t i = 0; whole && i < shape.counts.size(); ++i) {
      item = static_cast<std::uint32_t>(i);
      if (!shape.words[i].empty() && !next.word(shape.words[i])) {
        stop(RowEnd::word_differs);
        break;
      }
      for (std::uint32_t k = 0; whole && k < shape.counts[i]; ++k, ++column) {
        if (!next.number(row[column], shapes[column])) stop(RowEnd::number_expected);
      }
      if (whole && !next.line_end()) stop(RowEnd::line_end_expected);
    }
    // A line more than the shape has belongs to this row, not to the next.
    if (whole && shape.counter && next.p < next.end && !may_follow_row(*next.p)) {
      stop(RowEnd::counter_expected);
    }
    if (whole && next.p == start) whole = false;  // a shape without items
    if (!whole) {
      next.skip_blanks();
      parsed.end = end;
      parsed.error_offset = offset(next.p);
      parsed.error_item = item;
      parsed.offsets.push_back(offset(start));
      return parsed;
    }
    parsed.values.insert(parsed.values.end(), row.begin(), row.end());
    parsed.offsets.push_back(offset(start));
    if (shape.counter) parsed.counters.push_back(counter);
    for (std::size_t c = 0; c < columns; ++c) note(parsed.statistics[c], shapes[c]);
    cursor = next;
  }
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
    if (padded && take(text, length) && (p == end || is_blank(*p) || *p == '\n')) continue;
    // Another text for the number: up to the next blank, and with its padding where there is one.
    p = start;
    if (row.widths[k] > 0)
      while (p < end && *p == ' ') ++p;
    while (p < end && !is_blank(*p) && *p != '\n') ++p;
    if (p == start) return false;
    differing.push_back(
        {static_cast<std::uint32_t>(k), {start, static_cast<std::size_t>(p - start)}});
  }
  return take(literal->data(), literal->size()) && p == end;
}

}  // namespace mocapress
