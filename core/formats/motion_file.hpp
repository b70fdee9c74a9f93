// What the formats of motion files have in common: the entries by which Python and the page read.
//
// Each takes the bytes of a file, those of UTF-16 by way of `from_utf16`. None throws, and none
// trusts what the file says of its size. Where `fault` is set, nothing else is to be looked at.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/body.hpp"
#include "formats/columns.hpp"
#include "formats/problem.hpp"
#include "motion/skeleton.hpp"

namespace mocapress {

struct MotionFile {
  std::optional<Problem> fault;
  std::vector<Problem> problems;  // that loses_motion says whether strict reading refuses them
  Body body;
  std::vector<Column> columns;
  std::vector<Bone> bones;           // AMC: in the order of the columns
  std::vector<std::string> words;    // of these, as the file has them
  std::optional<Skeleton> skeleton;  // BVH: its own
  std::string frame_time;  // seconds, or with `is_rate` frames a second, as the file states it
  bool is_rate = false;
  double seconds = 0;  // per frame; 0 where the file does not say
  bool free = false;   // BVH: lines may end anywhere between numbers
};

struct SkeletonFile {
  std::optional<Problem> fault;
  Skeleton skeleton;
};

MotionFile read_bvh(std::string_view text);
// The skeleton is that of the ASF beside the AMC; null gives columns without joints.
MotionFile read_amc(std::string_view text, const Skeleton* skeleton);
SkeletonFile read_asf(std::string_view text);

// A number in a row's bytes: its column (-1: the frame's number), where it begins and ends.
struct Slot {
  std::int32_t column;
  std::uint32_t begin, end;
};

// The numbers of a row that was read; those of an AMC by their bones as `words` calls them.
std::vector<Slot> bvh_slots(std::string_view row, std::size_t columns);
std::vector<Slot> amc_slots(std::string_view row, const std::vector<std::string>& words,
                            const std::vector<std::uint32_t>& counts);

}  // namespace mocapress
