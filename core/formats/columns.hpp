// The columns of a clip: which joint each belongs to and what it does there.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/problem.hpp"
#include "motion/skeleton.hpp"

namespace mocapress {

struct Column {
  std::string name;  // `joint.kind`; `joint#2.kind` for the second joint of that name
  std::int32_t joint = -1;
  std::string kind;
  std::string_view unit;  // deg, rad, length or empty
};

// A bone of a motion file: how it is called there, and how many values a frame has for it.
struct Bone {
  std::string name;  // UTF-8
  std::uint32_t count = 0;
};

// Of all joints' channels, in the order of the joints.
std::vector<Column> skeleton_columns(const Skeleton& skeleton);

// Of bones, in the order in which a motion file names them. Joints are found by name, or else by
// name ignoring case; the n-th bone of a name is the n-th joint of that name, those without
// channels last. Without a skeleton the kinds are unknown, except for a first bone with six values,
// which is a root. The fault is a bone that the skeleton lacks, or has with other channels.
std::optional<Problem> bone_columns(const Skeleton* skeleton, std::span<const Bone> bones,
                                    bool radians, std::vector<Column>& columns);

}  // namespace mocapress
