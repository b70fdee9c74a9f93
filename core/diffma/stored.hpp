// DiffMA as a `.mcz` stores it: a codec header, and chunks of text (docs/format.md, "diffma").
#pragma once

#include <cstddef>
#include <string_view>

#include "coding/bit.hpp"

namespace mocapress::diffma {

// Fills `frames` x `columns` values, row by row, from a chunk's unpacked text. `fail`s where header
// or text are not what an encoder makes.
void decode_stored(ByteView header, std::string_view text, int bits, std::size_t window,
                   double* values, std::size_t frames, std::size_t columns);

}  // namespace mocapress::diffma
