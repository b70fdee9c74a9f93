// MRPA's header and the front of its chunks (docs/format.md, "mrpa"), as far as a decoder without a
// library reads them.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "app/codec.hpp"
#include "coding/bit.hpp"
#include "mrpa/codec.hpp"
#include "numbers/text.hpp"

namespace mocapress::mrpa {

// The columns of a clip whose source printed them in these formats. `fail`s where the header is not
// one of so many columns.
std::vector<app::Column> read_header(ByteView header, std::span<const NumberFormat> formats);

// The pieces of a chunk of so many frames, and what follows them. `fail`s where they are not so
// many, or need frames of other chunks.
std::pair<std::vector<Piece>, ByteView> read_pieces(ByteView payload, std::size_t frames);

}  // namespace mocapress::mrpa
