#include "app/header.hpp"

#include "coding/fail.hpp"

namespace mocapress::app {
namespace {

// Where rounding has moved a number away from, float64 where it cannot be told.
std::pair<Line, int> line_of(const NumberFormat& format) {
  int digits = format.digits;
  Line line = Line::float64;
  switch (format.kind) {
    case NumberKind::scientific:
      line = Line::significant;
      ++digits;
      break;
    case NumberKind::general:
      line = Line::significant;
      break;
    case NumberKind::fixed:
    case NumberKind::trimmed:
      line = Line::decimals;
      break;
    case NumberKind::shortest32:
      line = Line::shortest32;
      break;
    case NumberKind::shortest:
      break;
  }
  return {line_exists(static_cast<int>(line), digits) ? line : Line::float64, digits};
}

// 0: none; 2d: the column d before; 2d - 1: the column d after.
std::int32_t parent_of(std::size_t column, std::uint64_t distance, std::size_t columns) {
  if (distance == 0) return -1;
  const auto half = static_cast<std::int64_t>((distance + 1) / 2);
  const std::int64_t parent =
      static_cast<std::int64_t>(column) + (distance % 2 == 0 ? -half : half);
  if (parent < 0 || parent >= static_cast<std::int64_t>(columns)) {
    fail("a parent that is no column");
  }
  return static_cast<std::int32_t>(parent);
}

}  // namespace

Column column_of(const NumberFormat& format, std::uint64_t precision) {
  const auto [line, digits] = line_of(format);
  return {-1, static_cast<Precision>(precision), line, digits};
}

std::vector<std::int32_t> read_parents(Record& record, std::size_t columns) {
  const auto distances = record.runs(columns, 2 * columns);
  std::vector<std::int32_t> parents(columns);
  for (std::size_t c = 0; c < columns; ++c) parents[c] = parent_of(c, distances[c], columns);
  return parents;
}

std::vector<Column> read_header(ByteView header, std::span<const NumberFormat> formats) {
  Record record(header);
  const auto parents = read_parents(record, formats.size());
  const auto precisions = record.runs(formats.size(), static_cast<int>(Precision::snapped32));
  record.end();
  std::vector<Column> columns;
  columns.reserve(formats.size());
  for (std::size_t c = 0; c < formats.size(); ++c) {
    columns.push_back(column_of(formats[c], precisions[c]));
    columns.back().parent = parents[c];
  }
  return columns;
}

}  // namespace mocapress::app
