// The head of a .mcz file: its skeleton and its first stream. docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coding/bit.hpp"
#include "motion/kinematics.hpp"
#include "motion/skeleton.hpp"

namespace mocapress::player {

struct Stream {
  std::string name, kind;
  std::optional<std::uint64_t> frames;  // none in a recording
  double frame_time = 0;                // 0: not known
  std::vector<ChannelPlace> columns;
  bool radians = false;  // of columns
  std::string codec;
  std::map<std::string, std::int64_t> parameters;  // those that are whole numbers
  bool has_model = false;
  Bytes header;  // of the codec
};

struct Head {
  Skeleton skeleton;  // without joints where there is none
  std::vector<Stream> streams;
};

// `fail`s where it is none.
Head read_head(ByteView unpacked);

}  // namespace mocapress::player
