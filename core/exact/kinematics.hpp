// What a skeleton's geometry has to say about the channels of a frame, given those before them.
//
// Had every bone's end gone on as it went, the channels would have changed in certain ways; what
// they do instead moves as little mass as it can, where the mass at each end and the resistance of
// each channel are learned. So the second differences of a frame have the mass matrix for their
// precision, and each one's mean given those before it follows from the matrix's factors.
// docs/exact_kinematics.md has the formulas.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "exact/codec.hpp"
#include "exact/expert.hpp"
#include "exact/tables.hpp"
#include "motion/vector.hpp"

namespace mocapress::exact {

class Kinematics {
 public:
  // Of the columns that have a place among the skeleton's channels. Throws std::invalid_argument
  // where a place is impossible, or a channel stands before those of the joint's parent.
  explicit Kinematics(std::span<const Column> columns);

  // The frames before this one are known.
  void begin(const Frames& frames);

  // The second difference of a channel's levels, 0 for one that is not the skeleton's. The channels
  // before it are known.
  double guess(std::size_t channel, const Frames& frames) const;

 private:
  struct Channel {
    std::size_t column;
    double unit;  // from numbers to levels
    std::size_t place;
    std::size_t bone;
    std::vector<std::size_t> before;  // those that move the bone too, in order
    std::size_t row;                  // where its part of the matrix begins
  };

  struct Twist {  // per unit of a channel
    Vector linear, angular;
  };

  struct Pose {  // about the root's joint
    std::array<Matrix, kBones> turns;
    std::array<Vector, kBones> starts, ends;
  };

  // What moves with a bone: its mass, the mass's first and second moments; and what pushes it.
  struct Body {
    double mass;
    Vector moment;
    std::array<double, 6> tensor;  // xx yy zz xy xz yz
    Vector force, torque;
  };

  using Numbers = std::array<double, kSkeletonChannels>;

  void stand(const Numbers& numbers, Pose& pose);
  void weigh();
  void fill();
  void factor();

  std::vector<Channel> channels_;
  std::vector<int> channel_of_;      // per column: its place in channels_, or -1
  std::array<Matrix, kBones> axes_;  // C
  std::array<Twist, kSkeletonChannels> twists_;
  Pose expected_, last_, earlier_;
  std::array<Body, kBones> bodies_;
  std::vector<double> matrix_;  // per channel: its entries with those before it, then its own
  std::vector<double> pushes_;  // per channel
};

}  // namespace mocapress::exact
