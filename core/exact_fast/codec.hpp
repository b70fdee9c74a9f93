// The fast levels of `exact`, 1 to 5: one or two predictors, one scale and fixed tables per number.
// docs/format.md describes what they write.
#pragma once

#include <cstddef>

#include "exact/codec.hpp"

namespace mocapress::exact {

inline constexpr int kFastLevels = 5;

// As encode and decode of exact/codec.hpp. Starts have no meaning here, and nothing is learned.
Bytes encode_fast(const double* values, std::size_t frames, const Clip& clip, Start* learned);

void decode_fast(ByteView payload, double* values, std::size_t frames, const Clip& clip,
                 bool whole);

}  // namespace mocapress::exact
