// MRPA's header and its chunks (docs/format.md, "mrpa"), as far as a decoder without a library
// reads them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "app/codec.hpp"
#include "coding/bit.hpp"
#include "mrpa/codec.hpp"
#include "numbers/text.hpp"

namespace mocapress::mrpa {

// The columns of a clip whose source printed them in these formats. `fail`s where the header is not
// one of so many columns.
std::vector<app::Column> read_header(ByteView header, std::span<const NumberFormat> formats);

// Fills `values` from a chunk of so many frames. `fail`s where it is none, or needs frames of other
// chunks.
void decode_alone(ByteView payload, double* values, std::size_t frames,
                  std::span<const app::Column> columns, int mantissa_limit);

}  // namespace mocapress::mrpa
