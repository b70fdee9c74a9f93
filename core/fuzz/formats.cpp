// Motion files of any bytes; the rows that were read, printed by a template and compared with the
// bytes again; and numbers: what is printed in any format reads back, and the shortest text as the
// same number.
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "formats/detect.hpp"
#include "formats/header_pattern.hpp"
#include "formats/motion_file.hpp"
#include "formats/rows.hpp"
#include "formats/text.hpp"
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

// Rows that a reader gave: each printed by a template, and compared with the bytes again.
void check_body(std::string_view text, const Body& body, NumberFormat format) {
  const bool counted = !body.counters.empty();
  const std::size_t rows = body.rows();
  if (body.values.size() != rows * body.columns || (counted && body.counters.size() != rows))
    std::abort();
  for (std::size_t r = 0; r < rows; ++r)
    if (body.offsets[r] > body.offsets[r + 1] || body.offsets[r + 1] > text.size()) std::abort();
  const std::vector<NumberFormat> formats(body.columns, format);
  RowTemplate row{counted, {}, {}, {}};
  row.literals.assign(body.columns + 1 + counted, " ");
  for (std::uint32_t c = 0; c < body.columns; ++c) {
    row.columns.push_back(c);
    row.widths.push_back(static_cast<std::uint8_t>(c % 12 * 21));
  }
  std::vector<SlotText> differing;
  for (std::size_t r = 0; r < rows; ++r) {
    const std::int64_t counter = counted ? body.counters[r] : 0;
    const double* const values = body.values.data() + r * body.columns;
    std::string printed;
    print_row(printed, row, values, counter, formats.data(), {});
    match_row(text.substr(body.offsets[r], body.offsets[r + 1] - body.offsets[r]), row, values,
              counter, formats.data(), differing);
    if (!match_row(printed, row, values, counter, formats.data(), differing) || !differing.empty())
      std::abort();
  }
}

// A file that was read: its rows, and where their numbers stand.
void check_file(std::string_view text, const MotionFile& file, NumberFormat format) {
  if (file.fault) return;
  const Body& body = file.body;
  if (file.columns.size() != body.columns) std::abort();
  check_body(text, body, format);
  std::vector<bool> unread(body.rows());
  for (const std::int64_t r : body.unread) unread[static_cast<std::size_t>(r)] = true;
  std::vector<std::uint32_t> counts;
  counts.reserve(file.bones.size());
  for (const Bone& bone : file.bones) counts.push_back(bone.count);
  Sample sample;
  for (std::size_t r = 0; r < body.rows(); ++r) {
    if (unread[r]) continue;
    const std::size_t first = sample.texts.size();
    sample.texts.resize(first + body.columns);
    const auto row = body.values.begin() + static_cast<std::ptrdiff_t>(r * body.columns);
    sample.values.insert(sample.values.end(), row, row + static_cast<std::ptrdiff_t>(body.columns));
    const auto bytes = text.substr(body.offsets[r], body.offsets[r + 1] - body.offsets[r]);
    const auto slots =
        file.skeleton ? bvh_slots(bytes, body.columns) : amc_slots(bytes, file.words, counts);
    for (const auto& [column, begin, end] : slots) {
      if (column < 0) continue;
      double value = 0;
      NumberShape shape;
      Scanner scanner{bytes.substr(0, end), begin};
      if (static_cast<std::size_t>(column) >= body.columns || !scanner.number(value, shape))
        std::abort();
      sample.texts[first + static_cast<std::size_t>(column)] = bytes.substr(begin, end - begin);
      const double read = body.values[r * body.columns + static_cast<std::size_t>(column)];
      if (!(value == read) && (value == value || read == read)) std::abort();
    }
  }
  if (detect_formats(body.statistics, sample).size() != body.columns) std::abort();
}

// A header as a pattern, and any pattern: what comes of it is the header, or no longer than
// allowed.
void check_header(std::string_view text) {
  HeaderReferences refer{{"hip", std::nullopt, "knee"},
                         {"1 Xrotation", std::nullopt, "0"},
                         {0, -0.0, 1.5, 1e300, 2, 3},
                         "0.01",
                         4};
  HeaderStyle style{"\n", "  ", {}};
  const auto [pattern, formats] = header_pattern(text, refer, style);
  style.formats = formats;
  const char* why = nullptr;
  const auto back = print_header(pattern, refer, style, text.size(), why);
  if (!back || *back != text) std::abort();
  const auto any = print_header(text, refer, style, 300, why);
  if (any ? any->size() > 300 : why == nullptr) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  NumberFormat format{static_cast<NumberKind>(data[0] % 6),
                      static_cast<std::uint8_t>(data[1] % (kMostDigits + 1)),
                      static_cast<std::uint8_t>(data[2] % 9),
                      (data[3] & 1) != 0,
                      (data[3] & 2) != 0,
                      (data[3] & 4) != 0,
                      (data[3] & 8) != 0,
                      (data[3] & 16) != 0,
                      (data[3] & 32) != 0,
                      (data[3] & 64) != 0,
                      (data[3] & 192) == 128};
  if (format.kind == NumberKind::general)
    format.digits = static_cast<std::uint8_t>(1 + data[1] % 17);
  for (std::size_t at = 4; at + 8 <= size && at < 256; at += 8) {
    double value;
    std::memcpy(&value, data + at, 8);
    check_number(value, format);
    check_number(static_cast<double>(static_cast<float>(value)), format);
  }
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check_body(text, read_rows(text, 0, 1U + data[3] % 5), format);
  check_file(text, read_bvh(text), format);
  check_file(text, read_amc(text, nullptr), format);
  const SkeletonFile asf = read_asf(text);
  if (!asf.fault) check_file(text, read_amc(text, &asf.skeleton), format);
  from_utf16(text);
  check_header(text);
  return 0;
}
