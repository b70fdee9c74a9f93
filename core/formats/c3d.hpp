// What stands where in a C3D file: its parameters, and how its frames are laid out.
//
// Headers of many makers are wrong in one place or another, so that no number in them is trusted:
// ways to lay out the frames are tried one after the other, and the one that fills the file is
// taken. Nothing is copied; every length is checked against the bytes there are.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "coding/bit.hpp"

namespace mocapress {

enum class C3dProcessor : std::uint8_t { intel = 84, dec = 85, mips = 86 };

// A parameter, or a group of them (then without data).
struct C3dParameter {
  int group = 0;
  bool is_group = false;
  std::string_view name;
  int type = 0;  // -1 text, 1 bytes, 2 integers of 16 bits, 4 floats
  ByteView dimensions;
  std::uint64_t begin = 0;  // of its data in the file
  std::uint64_t size = 0;   // in bytes
};

// Frames that follow each other, each a record of so many numbers.
struct C3dFrames {
  std::uint64_t begin = 0;  // in the file
  std::uint64_t count = 0;
  std::uint64_t numbers = 0;
};

struct C3dLayout {
  C3dProcessor processor = C3dProcessor::intel;
  bool floats = false;
  std::uint64_t announced = 0;  // frames
  std::uint64_t points = 0;     // four numbers each
  std::uint64_t analog = 0;     // numbers in a frame
  std::uint64_t samples = 1;    // of each analog channel in a frame
  C3dFrames frames;             // of points and analog; a count of 0: none were found
  bool stated = false;          // whether header or a parameter says that they are so many
  C3dFrames rotations;          // 17 numbers each
  std::vector<C3dParameter> parameters;
};

// Of a file of so many bytes, of which `data` is the beginning.
C3dLayout c3d_layout(ByteView data, std::uint64_t file_size);

}  // namespace mocapress
