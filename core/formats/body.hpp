// The body of a motion file as a matrix, and how its numbers are written.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/columns.hpp"
#include "formats/problem.hpp"
#include "formats/scanner.hpp"
#include "numbers/text.hpp"

namespace mocapress {

struct ColumnStatistics {
  std::uint8_t least_decimals = 255;  // among numbers without an exponent
  std::uint8_t most_decimals = 0;
  std::uint8_t most_significant = 0;
  std::uint8_t exponent_digits = 0;  // fewest seen, 0 where no exponent was
  bool trailing_zero = false;
  bool whole_without_point = false;
  bool bare_point = false;
  bool upper = false;
  bool plus = false;
  bool leading_zero = false;
  bool end_point = false;

  bool operator==(const ColumnStatistics&) const = default;
};

// Adds a number of a column.
void note(ColumnStatistics& column, const NumberShape& shape);

struct Body {
  std::size_t columns = 0;
  std::vector<double> values;          // rows x columns
  std::vector<std::int64_t> counters;  // frame numbers, where rows have them
  std::vector<std::uint64_t> offsets;  // where each row begins; one more for the end
  std::vector<ColumnStatistics> statistics;
  std::vector<std::int64_t> unread;  // rows that cannot be read; they hold the row before

  std::size_t text_size = 0;

  explicit Body(std::size_t width = 0, std::size_t size = 0)
      : columns(width), statistics(width), text_size(size) {}
  std::size_t rows() const { return offsets.empty() ? 0 : offsets.size() - 1; }
};

// One row while it is read.
struct Row {
  std::vector<double> values;
  std::vector<NumberShape> shapes;
  std::vector<bool> given;  // which columns the row has; all where it is empty
  std::int64_t counter = 0;

  explicit Row(std::size_t columns) : values(columns), shapes(columns) {}
};

enum class RowEnd : std::uint8_t {
  whole,
  end_of_data,
  word_differs,
  number_expected,
  line_end_expected,
  counter_expected,
};

// Where reading a row ended, and why.
struct RowStop {
  RowEnd end = RowEnd::whole;
  std::uint64_t begin = 0;  // of the row
  std::uint64_t next = 0;   // where it ended: the next row, or what should have been otherwise
  std::uint32_t item = 0;   // which line of the row that is
};

// A frame that holds what the one before has costs its file two bytes, whatever its width.
inline std::size_t most_values(std::size_t text_size) {
  return (std::size_t{1} << 24) + 8 * text_size;
}

struct Reading {
  bool too_many = false;       // values; the body is not whole
  std::vector<RowStop> stops;  // one for each row of Body::unread
  std::vector<RowStop>
      waiting;  // rows at the end that cannot be read; they are no part of the body
};

// After so many rows in succession that cannot be read, what follows is no motion.
inline constexpr std::size_t kMostUnreadable = 64;

void append_row(Body& body, const Row& row, std::uint64_t begin, bool counted);
// Rows for those that cannot be read, which hold the row before, or `after` where there is none.
void append_held(Body& body, const std::vector<RowStop>& waiting, const Row& after, bool counted);

// Reads rows up to the end of the text, and past rows that cannot be read. `read_row` fills the row
// from an offset; `resume` gives where the next row may begin, from where one cannot be read.
template <class ReadRow, class Resume>
Reading read_all(std::string_view text, std::size_t begin, bool counted, Body& body, Row& row,
                 ReadRow read_row, Resume resume) {
  Reading reading;
  std::vector<RowStop>& waiting = reading.waiting;
  Scanner scanner{text, begin};
  while (true) {
    scanner.skip_empty_lines();
    RowStop stop = read_row(scanner.at);
    stop.begin = scanner.at;
    if (stop.end == RowEnd::whole) {
      append_held(body, waiting, row, counted);
      reading.stops.insert(reading.stops.end(), waiting.begin(), waiting.end());
      waiting.clear();
      append_row(body, row, stop.begin, counted);
      scanner.at = stop.next;
      reading.too_many = body.values.size() > most_values(text.size());
      if (!reading.too_many) continue;
      body.offsets.push_back(text.size());
      return reading;
    }
    if (stop.end == RowEnd::end_of_data || waiting.size() == kMostUnreadable) {
      body.offsets.push_back(waiting.empty() ? stop.begin : waiting.front().begin);
      return reading;
    }
    waiting.push_back(stop);
    scanner.at = resume(scanner.at);
  }
}

// What is wrong with a body: rows that cannot be read, the last of them the one where reading
// ended where it is `cut`; something behind the last row; values that are no numbers, by the names
// of their columns.
Problem too_many(const Body& body);
Problem unreadable(std::string_view text, const Body& body, const Reading& reading,
                   std::string expected, bool cut);
Problem bytes_after_end(std::string_view text, const Body& body);
std::optional<Problem> not_numbers(std::string_view text, const Body& body,
                                   const std::vector<Column>& columns);

}  // namespace mocapress
