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

#include "formats/body.hpp"
#include "numbers/text.hpp"

namespace mocapress {

// Reads rows of so many numbers, a line each, from an offset on, until one differs or the text
// ends. Where the last offset is, there is what could not be read, if anything.
Body read_rows(std::string_view text, std::uint64_t begin, std::size_t columns);

// Fills a row with the numbers from an offset on, up to the end of the line; `free`: wherever lines
// end between and behind them.
RowStop read_numbers(std::string_view text, std::uint64_t begin, bool free, Row& row);

// Bytes of one kind of row: literals[0] slot literals[1] slot ... literals[n]. With a counter, the
// first slot is the frame's number. `columns[k]` is the column of slot k.
struct RowTemplate {
  bool counter = false;
  std::vector<std::string> literals;
  std::vector<std::uint32_t> columns;
  std::vector<std::uint8_t> widths;
  std::uint8_t counter_width = 0;  // to which zeros pad the frame's number
};

// Widths: 0: as it is; to 127: padded on the left to this width; 128: with a blank where there is
// no sign; above: padded with blanks on the right to the width less 128.
inline constexpr std::uint8_t kBlankSign = 128;

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
