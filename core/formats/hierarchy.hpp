// The first part of a BVH file: the skeleton, and what the section MOTION declares.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "formats/problem.hpp"
#include "motion/skeleton.hpp"

namespace mocapress {

struct Hierarchy {
  std::optional<Problem> fault;
  Skeleton skeleton;
  std::uint64_t frames = 0;  // as declared
  std::string frame_time;    // as declared
  double seconds = 0;
  std::size_t rows_begin = 0;  // byte offset of the first row
};

Hierarchy read_hierarchy(std::string_view text);

}  // namespace mocapress
