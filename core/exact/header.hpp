// The codec header of `exact`: which columns of a clip a chunk holds, and how they are coded
// (docs/format/exact.md, "Codec header").
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "coding/bit.hpp"
#include "exact/codec.hpp"
#include "exact/restoring.hpp"

namespace mocapress::exact {

struct Header {
  std::vector<std::size_t> coded;  // the columns that chunks hold, in the order of coding
  std::vector<Column> columns;     // of these
  std::vector<Coupling> couplings;
  std::vector<std::pair<std::size_t, double>> constants;    // a column, and all its numbers
  std::vector<std::pair<std::size_t, std::size_t>> copies;  // a column, and the one it copies
  Restoring beside;
  bool has_model = false;
  int level = 0;  // where it is another than the clip's; else 0
};

// All below `fail` where the bytes are not what an encoder makes.

Header read_header(ByteView header, std::size_t columns);

// What a coder of these columns begins with, of the payload of a model.
Start read_start(ByteView model, const Header& header);

// Fills the first `wanted` x `columns` values of a chunk of so many frames.
void decode(ByteView payload, double* values, std::size_t frames, std::size_t wanted,
            std::size_t columns, const Header& header, int level, const Start& start);

}  // namespace mocapress::exact
