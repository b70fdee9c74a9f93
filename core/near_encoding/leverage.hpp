// How far the channels of a clip move its figure: what a rounding error costs, and what later
// channels can make good of it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "motion/kinematics.hpp"

namespace mocapress::near {

// In what errors are measured: of a joint, by three points at a distance along its axes; without
// a rig, of every value by itself.
struct Measure {
  std::shared_ptr<const Rig> rig;
  bool radians = false;
  double radius = 0;           // of the points, in the units of lengths
  std::vector<double> others;  // of each channel, if it moves no joint: what an error of 1 counts

  std::size_t points(std::size_t channels) const { return rig ? rig->joints() : channels; }
  // The errors of a frame, `points` of them; without a rig, as the channels count.
  void errors(const double* row, const double* other, std::size_t channels, double* errors) const;
  // With a rig: of each joint its place and its three points.
  std::vector<Vector> places(const double* row) const;
};

// Of every channel what it costs to be off by 1, squared, after all channels behind it have made
// good what they can; and how much of each channel's error before it a channel makes good.
class Leverage {
 public:
  // `weights` of points; channels that do not move are left out.
  Leverage(const Measure& measure, std::size_t channels, std::vector<double> weights,
           std::vector<bool> moves);

  // The channels before channel c whose errors it makes good.
  std::span<const std::size_t> before(std::size_t c) const { return before_[c]; }
  // Of all channels together, and where those of a channel begin.
  std::size_t pairs() const { return pairs_; }
  std::size_t begin_of(std::size_t c) const { return begins_[c]; }

  // Fills `costs`, one a channel, and `shares`, `pairs` of them.
  void of_frame(const double* row, double* costs, float* shares);

 private:
  struct Moments;
  double pair(std::size_t a, std::size_t b) const;
  void gather(const double* row);

  const Measure& measure_;
  std::size_t channels_;
  std::vector<double> weights_;
  std::vector<Rig::Action> actions_;  // of channels that move
  std::vector<std::vector<std::size_t>> before_;
  std::vector<std::vector<std::size_t>> earlier_;  // actions, of each action
  std::vector<std::size_t> begins_;
  std::size_t pairs_ = 0;
  // Of a frame: what is below each joint, about the first joint's place.
  std::vector<double> zeroth_;
  std::vector<Vector> first_, places_, directions_;
  std::vector<Matrix> second_;
  std::vector<double> joint_places_, joint_turns_, matrix_;
};

}  // namespace mocapress::near
