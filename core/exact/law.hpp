// Laws of a motion capture solver: angles of one joint as closed functions of angles of the joints
// before it. docs/exact.md says how they were found and how far they reach.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "motion/vector.hpp"

namespace mocapress::exact {

// spine, neck: from x, y, z of two joints to y, x, z of the third, in a chain of three that turn
// about z, y, x. thumb, other_thumb: from x, z of the hand to x, z of the thumb.
// spine_middle, neck_middle: from x, y, z of the first joint and x, z of the second to y of the
// second.
enum class LawKind : std::uint8_t {
  spine = 1,
  neck = 2,
  thumb = 3,
  other_thumb = 4,
  spine_middle = 6,
  neck_middle = 7
};

// The most that a law has.
inline constexpr std::size_t kLawSources = 6;
inline constexpr std::size_t kLawTargets = 3;

// A law of a chain has branches; the one that was right in the last frame is taken to be right in
// this one, until a target says otherwise.
class Law {
 public:
  explicit Law(LawKind kind) : kind_(kind) {}

  static std::size_t sources(LawKind kind);
  static std::size_t targets(LawKind kind);

  // The angles of the sources, in degrees.
  void begin(const double* sources);

  // A target in degrees, up to whole turns; those before it in `targets` are known. Targets are
  // asked for one after the other.
  double predict(std::size_t target, const double* targets);

 private:
  void begin_chain(const double* sources);
  void begin_middle(const double* sources);
  Vector last_axis(std::size_t branch, std::array<double, 2>& bends) const;
  void choose_branch(double seen, double cosine_y);

  LawKind kind_;
  Vector axis_{};      // where the last joint's y axis points, seen by the joint before
  double first_ = 0;   // the first target
  double slope_ = -1;  // of what a middle's law is off; at first that of the twist alone
  double thumb_turn_ = 0;
  Matrix second_{};  // the axes of the joint before the last
  Vector y1_{};      // the y axis of the first one
  std::size_t branch_ = 0;
  std::array<double, 2> bends_{};  // of the last joint against the parent and the first joint
};

}  // namespace mocapress::exact
