// Chunks of the codecs that libmocapress knows.
#pragma once

#include "player/head.hpp"
#include "player/sections.hpp"

namespace mocapress::player {

// Throws Unsupported where a stream is of another codec, or needs a model.
void check_codec(const Stream& stream);

// Fills frames x columns values, row by row. `fail`s where the chunk is not what an encoder makes.
void decode(const Stream& stream, const Chunk& chunk, double* values);

}  // namespace mocapress::player
