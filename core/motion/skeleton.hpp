// The skeleton of a clip: a tree of joints, parents before children. The conventions are those of
// mocapress.motion.skeleton.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/vector.hpp"

namespace mocapress {

// What a channel does: move along, turn about or scale an axis; `stretch` is ASF's `l`.
enum class Kind : std::uint8_t { tx, ty, tz, rx, ry, rz, stretch, sx, sy, sz };

inline constexpr std::array<std::string_view, 10> kKindNames = {"tx", "ty", "tz", "rx", "ry",
                                                                "rz", "l",  "sx", "sy", "sz"};

inline std::string_view name_of(Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }
inline bool is_rotation(Kind kind) { return kind >= Kind::rx && kind <= Kind::rz; }
inline bool is_translation(Kind kind) { return kind <= Kind::tz; }
inline bool is_scale(Kind kind) { return kind >= Kind::sx; }
// 0, 1, 2 for x, y, z.
inline std::size_t axis_of(Kind kind) {
  return (static_cast<std::size_t>(kind) - (is_scale(kind) ? 7 : 0)) % 3;
}

struct Joint {
  std::string name;          // UTF-8
  std::int32_t parent = -1;  // smaller than the joint's own index
  Vector offset{};           // from the parent's joint, in the parent's frame
  std::vector<Kind> channels;
  Vector axis{};                   // ASF: angles of the frame in which the channels turn
  std::string axis_order = "xyz";  // in which they are applied, about fixed axes
  std::vector<std::pair<double, double>> limits;
  std::vector<Vector> ends;  // end sites, in this joint's frame
};

struct Skeleton {
  std::vector<Joint> joints;
  bool fixed = false;    // rotations from right to left, about fixed axes (ASF)
  bool radians = false;  // of channels, axes and limits
  std::optional<double> length_unit;
  std::string name;
  std::string mass;
};

}  // namespace mocapress
