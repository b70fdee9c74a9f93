// Forward kinematics for JavaScript: viewer/page/work/placing.js and npm/clip.js call it.
#include "motion/kinematics.hpp"

#include <cstdint>
#include <optional>
#include <vector>

#include "coding/fail.hpp"
#include "wasm/space.hpp"

namespace mocapress::wasm {
namespace {

std::optional<Rig> rig;
std::vector<double> places, turns;

// What JavaScript wrote for `rig`: a skeleton and columns as numbers.
class Told {
 public:
  explicit Told(std::size_t count) : left_(count), next_(space().data()) {}

  double take() {
    if (left_ == 0) fail("a rig that is cut off");
    --left_;
    return *next_++;
  }
  std::size_t below(std::size_t bound) {
    const double value = take();
    if (!(value >= 0 && value < static_cast<double>(bound))) fail("a rig of what is no skeleton");
    return static_cast<std::size_t>(value);
  }
  Vector vector() {
    Vector made;
    for (double& x : made) x = take();
    return made;
  }
  bool done() const { return left_ == 0; }

 private:
  std::size_t left_;
  const double* next_;
};

constexpr std::size_t kMostJoints = 1 << 16;

Joint joint_of(Told& told, std::size_t index) {
  Joint joint;
  joint.parent = static_cast<std::int32_t>(told.below(index + 1)) - 1;
  joint.offset = told.vector();
  joint.axis = told.vector();
  joint.axis_order.clear();
  for (int i = 0; i < 3; ++i) joint.axis_order += "xyz"[told.below(3)];
  for (auto count = told.below(1 << 20); count > 0; --count) {
    joint.channels.push_back(static_cast<Kind>(told.below(kKindNames.size())));
  }
  for (auto count = told.below(1 << 20); count > 0; --count) {
    joint.ends.push_back(told.vector());
  }
  return joint;
}

}  // namespace
}  // namespace mocapress::wasm

using namespace mocapress;
using namespace mocapress::wasm;

extern "C" {

// Takes a skeleton and columns, which stand in the space as so many numbers: whether it is of fixed
// rotation, whether angles of its axes are radians, whether those of the columns are; joints, and
// of each parent + 1, offset, axis, its order, channels, ends; columns, and of each joint + 1 and
// kind. Gives the number of points.
[[clang::export_name("rig")]] std::size_t mocapress_rig(std::size_t count) {
  Told told(count);
  Skeleton skeleton;
  skeleton.fixed = told.below(2) == 1;
  skeleton.radians = told.below(2) == 1;
  const bool radians = told.below(2) == 1;
  const std::size_t joints = told.below(kMostJoints + 1);
  for (std::size_t i = 0; i < joints; ++i) skeleton.joints.push_back(joint_of(told, i));
  std::vector<ChannelPlace> columns;
  for (auto left = told.below((1 << 20) + 1); left > 0; --left) {
    const auto joint = static_cast<std::int32_t>(told.below(joints + 1)) - 1;
    columns.push_back({joint, static_cast<Kind>(told.below(kKindNames.size()))});
  }
  if (!told.done()) fail("a rig of too many numbers");
  rig.emplace(skeleton, columns, radians);
  return rig->points();
}

// Places all points of so many rows, which stand in the space: (F, P, 3), or null where a row
// stretches bones.
[[clang::export_name("place")]] const double* mocapress_place(std::size_t frames,
                                                              std::size_t columns) {
  if (!rig) fail("no rig");
  places.resize(frames * rig->points() * 3);
  turns.resize(rig->joints() * 4);
  for (std::size_t f = 0; f < frames; ++f) {
    const double* const row = space().data() + f * columns;
    if (rig->stretches(row)) return nullptr;
    rig->place(row, places.data() + f * rig->points() * 3, turns.data());
  }
  return places.data();
}

// What joints do relative to their parents in so many rows, which stand in the space: of each row
// the joints' places, (J, 3), then their turns, (J, 4) with the scalar first; or null where a row
// stretches bones.
[[clang::export_name("place_locally")]] const double* mocapress_place_locally(std::size_t frames,
                                                                              std::size_t columns) {
  if (!rig) fail("no rig");
  const std::size_t joints = rig->joints();
  places.resize(frames * joints * 7);
  for (std::size_t f = 0; f < frames; ++f) {
    const double* const row = space().data() + f * columns;
    if (rig->stretches(row)) return nullptr;
    double* const own = places.data() + f * joints * 7;
    rig->place_locally(row, own, own + joints * 3);
  }
  return places.data();
}

}  // extern "C"
