// The body of a motion file as rows: finding the numbers, and printing them again.
//
// A row is a sequence of items. Reading is tolerant (any run of blanks is as good as another,
// empty lines and lines that begin with '#' are passed over); printing follows a template to the
// byte, and what differs from the file is found by comparing the two.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "numbers/text.hpp"

namespace mocapress {

// One row's items: `counts[i]` numbers behind word `words[i]` (empty: none), one line each. AMC
// rows begin with a line that holds the frame's number.
struct RowShape {
  bool counter = false;
  std::vector<std::string> words;
  std::vector<std::uint32_t> counts;
  std::size_t columns() const;
};

struct ColumnStatistics {
  std::uint8_t least_decimals = 255;  // among numbers without an exponent
  std::uint8_t most_decimals = 0;
  std::uint8_t most_significant = 0;
  std::uint8_t exponent_digits = 0;  // fewest seen, 0 where no exponent was
  bool trailing_zero = false;
  bool whole_without_point = false;
  bool bare_point = false;
  bool upper = false;
};

enum class RowEnd {
  end_of_data,
  word_differs,
  number_expected,
  line_end_expected,
  limit,
  counter_expected
};

struct ParsedRows {
  std::vector<double> values;          // rows x columns
  std::vector<std::int64_t> counters;  // one per row where the shape has a counter
  std::vector<std::uint64_t> offsets;  // where each row's first item begins; one more for the end
  std::vector<ColumnStatistics> statistics;
  RowEnd end = RowEnd::end_of_data;
  std::uint64_t error_offset = 0;  // where the item that ended the parsing stands
  std::uint32_t error_item = 0;    // its line within the row
};

ParsedRows parse_rows(std::string_view data, std::uint64_t begin, const RowShape& shape,
                      std::uint64_t most_rows);

// Bytes of one kind of row: literals[0] slot literals[1] slot ... literals[n]. With a counter, the
// first slot is the frame's number. `columns[k]` is the column of slot k; a width above 0 says that
// the number is padded with blanks on the left.
struct RowTemplate {
  bool counter = false;
  std::vector<std::string> literals;
  std::vector<std::uint32_t> columns;
  std::vector<std::uint8_t> widths;
};

struct SlotText {
  std::uint32_t slot;
  std::string_view text;
};

// Appends one row; the numbers of `replaced` (by slot, ascending) have the text given there.
void print_row(std::string& out, const RowTemplate& row, const double* values, std::int64_t counter,
               const NumberFormat* formats, const std::vector<SlotText>& replaced);

// Compares a row's bytes with what the template prints. False where more than numbers differ;
// otherwise `differing` has the numbers whose text is another.
bool match_row(std::string_view bytes, const RowTemplate& row, const double* values,
               std::int64_t counter, const NumberFormat* formats, std::vector<SlotText>& differing);

}  // namespace mocapress
