// The sections of a .mcz file: docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/bit.hpp"

namespace mocapress::player {

struct Chunk {
  std::size_t stream;
  std::uint64_t flags, first, frames;
  std::uint32_t digest;  // CRC-32 of the values
  bool own_header;
  ByteView header;  // of the codec, where it is the chunk's own
  ByteView payload;
};

struct Sections {
  ByteView head;
  std::vector<Chunk> chunks;  // in the order of the file
  bool has_original = false;
  bool closed = false;  // else the file is a recording that was cut off
};

// Takes a file apart, of which the parts are views. `fail`s where it is damaged.
Sections read_sections(ByteView file);

std::uint32_t checksum(const void* data, std::size_t size);

// Whether a checksum fits what it is of. Fuzzing takes all for right, to come further.
bool fits(std::uint32_t stored, const void* data, std::size_t size);

}  // namespace mocapress::player
