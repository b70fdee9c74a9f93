// Rows read from any bytes; what was read, printed by a template and compared with the bytes again;
// and numbers: what is printed in any format reads back, and the shortest text as the same number.
#include "formats/rows.hpp"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "numbers/text.hpp"

using namespace mocapress;

namespace {

void check_number(double value, NumberFormat format) {
  char text[kLongestNumber];
  const char* const end = print_number(text, value, format);
  if (end > text + sizeof text) std::abort();
  if (format.kind == NumberKind::shortest32) value = static_cast<float>(value);
  if (value - value != 0) return;  // not finite: printed as a word
  double read = 0;
  NumberShape shape;
  if (parse_number(text, end, read, shape) != end) {
    // Rounding may lead beyond the largest double; nothing else may fail.
    if (value < 1e307 && value > -1e307) std::abort();
    return;
  }
  if (format.kind == NumberKind::shortest &&
      std::bit_cast<std::uint64_t>(read) != std::bit_cast<std::uint64_t>(value))
    std::abort();
}

void check_rows(std::string_view text, const RowShape& shape, NumberFormat format) {
  const ParsedRows rows = parse_rows(text, 0, shape, 1000);
  const std::size_t columns = shape.columns();
  if (rows.offsets.empty() || rows.values.size() != (rows.offsets.size() - 1) * columns)
    std::abort();
  if (rows.offsets.back() > text.size() || rows.error_offset > text.size()) std::abort();
  const std::vector<NumberFormat> formats(columns, format);
  RowTemplate row{shape.counter, {}, {}, {}};
  row.literals.assign(columns + 1 + shape.counter, " ");
  for (std::uint32_t c = 0; c < columns; ++c) {
    row.columns.push_back(c);
    row.widths.push_back(static_cast<std::uint8_t>(c % 12));
  }
  std::vector<SlotText> differing;
  for (std::size_t r = 0; r + 1 < rows.offsets.size(); ++r) {
    const std::int64_t counter = shape.counter ? rows.counters[r] : 0;
    const double* const values = rows.values.data() + r * columns;
    std::string printed;
    print_row(printed, row, values, counter, formats.data(), {});
    match_row(text.substr(rows.offsets[r], rows.offsets[r + 1] - rows.offsets[r]), row, values,
              counter, formats.data(), differing);
    if (!match_row(printed, row, values, counter, formats.data(), differing) || !differing.empty())
      std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  NumberFormat format{static_cast<NumberKind>(data[0] % 6),
                      static_cast<std::uint8_t>(data[1] % (kMostDigits + 1)),
                      static_cast<std::uint8_t>(data[2] % 9),
                      (data[3] & 1) != 0,
                      (data[3] & 2) != 0,
                      (data[3] & 4) != 0};
  if (format.kind == NumberKind::general)
    format.digits = static_cast<std::uint8_t>(1 + data[1] % 17);
  for (std::size_t at = 4; at + 8 <= size && at < 256; at += 8) {
    double value;
    std::memcpy(&value, data + at, 8);
    check_number(value, format);
    check_number(static_cast<double>(static_cast<float>(value)), format);
  }
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check_rows(text, {false, {""}, {1U + data[3] % 5}}, format);
  check_rows(text, {true, {"root", "hip"}, {6, 2}}, format);
  return 0;
}
