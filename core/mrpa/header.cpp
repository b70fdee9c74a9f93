#include "mrpa/header.hpp"

#include "app/header.hpp"
#include "coding/fail.hpp"
#include "coding/record.hpp"

namespace mocapress::mrpa {

std::vector<app::Column> read_header(ByteView header, std::span<const NumberFormat> formats) {
  Record record(header);
  const auto precisions = record.runs(formats.size(), static_cast<int>(app::Precision::snapped32));
  record.end();
  std::vector<app::Column> columns;
  columns.reserve(formats.size());
  for (std::size_t c = 0; c < formats.size(); ++c) {
    columns.push_back(app::column_of(formats[c], precisions[c]));
  }
  return columns;
}

std::pair<std::vector<Piece>, ByteView> read_pieces(ByteView payload, std::size_t frames) {
  Record record(payload);
  std::vector<Piece> pieces(record.integer(record.left() / 2));
  std::size_t left = frames;
  for (auto& piece : pieces) {
    piece = {static_cast<std::size_t>(record.integer(left)), false, false};
    left -= piece.frames;
    if (record.integer() != 0) fail("a chunk needs frames of other clips");
  }
  if (left != 0) fail("frames are in no piece");
  return {std::move(pieces), record.raw(record.left())};
}

}  // namespace mocapress::mrpa
