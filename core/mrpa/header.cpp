#include "mrpa/header.hpp"

#include <array>

#include "app/header.hpp"
#include "coding/fail.hpp"
#include "coding/record.hpp"

namespace mocapress::mrpa {
namespace {

// How chunks are coded as APP codes them.
constexpr std::array<double, 8> kAlphas = {-1, -0.5, -0.25, 0, 0.25, 0.5, 1, 2};
constexpr std::size_t kCluster = 15;
constexpr std::uint64_t kMostMantissa = 53;

}  // namespace

std::vector<app::Column> read_header(ByteView header, std::span<const NumberFormat> formats) {
  Record record(header);
  const auto precisions = record.runs(formats.size(), static_cast<int>(app::Precision::snapped32));
  std::vector<std::int32_t> parents(formats.size(), -1);
  if (record.left() != 0) parents = app::read_parents(record, formats.size());
  record.end();
  std::vector<app::Column> columns;
  columns.reserve(formats.size());
  for (std::size_t c = 0; c < formats.size(); ++c) {
    columns.push_back(app::column_of(formats[c], precisions[c]));
    columns.back().parent = parents[c];
  }
  return columns;
}

void decode_alone(ByteView payload, double* values, std::size_t frames,
                  std::span<const app::Column> columns, int mantissa_limit) {
  Record record(payload);
  std::vector<Piece> pieces(record.integer(record.left() / 2));
  if (pieces.empty() && frames != 0) {
    const auto limit = static_cast<int>(record.integer(kMostMantissa));
    if (limit == 0) fail("no limit of mantissas");
    app::decode(record.raw(record.left()), values, frames, columns, {kAlphas, kCluster, limit});
    return;
  }
  std::size_t left = frames;
  for (auto& piece : pieces) {
    piece = {static_cast<std::size_t>(record.integer(left)), false, false};
    left -= piece.frames;
    if (record.integer() != 0) fail("a chunk needs frames of other clips");
  }
  if (left != 0) fail("frames are in no piece");
  decode(record.raw(record.left()), values, nullptr, pieces, columns, mantissa_limit);
}

}  // namespace mocapress::mrpa
