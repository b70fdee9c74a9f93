// A decoder for JavaScript: each codec is a module of its own, which links core/wasm/CODEC.cpp.
// viewer/mcz/decoding.js calls it.
#pragma once

#include <cstddef>
#include <span>

#include "coding/bit.hpp"

namespace mocapress::wasm {

// A chunk to be decoded; sizes have been checked against nothing.
struct Request {
  std::size_t columns, frames;
  std::span<const double> parameters;  // of the codec, in an order of its own
  ByteView formats;                    // of each column, how it was printed: kind and digits
  ByteView header;                     // of the codec
  ByteView model;                      // its payload; empty where there is none
  ByteView payload;
};

// Fills frames x columns values, row by row.
void decode(const Request& request, double* values);

}  // namespace mocapress::wasm
