// Whole turns of a channel of angles that jumps by 360 degrees where it leaves its range: such a
// channel is predicted as an angle that goes on, and coded as the file has it.
#pragma once

#include <array>
#include <cmath>

#include "coding/bit.hpp"

namespace mocapress::exact {

class Turns {
 public:
  // Numbers lie between `lowest` and `lowest` + 360.
  explicit Turns(double lowest) : lowest_(lowest) {}

  // The whole turns, in degrees, by which a prediction has left the range.
  double left(double predicted) const { return kTurn * floor((predicted - lowest_) / kTurn); }

  // The whole turns, in degrees, that bring a number closest to the angle before it.
  static double since(double before, double number) {
    return kTurn * floor((before - number) / kTurn + 0.5);
  }

  // What to take from a prediction, so that it lies close to `number`, which is expected within
  // some `scale`: the turns that it has left the range, unless an edge is between the two.
  template <class Side>
  double code(Side& side, double predicted, double scale, double number) {
    const double turns = left(predicted);
    const double within = predicted - turns - lowest_;
    const bool low = within < kTurn / 2;
    const double scales = (low ? within : kTurn - within) / scale;
    if (!(scales < kReach)) return turns;
    const bool across =
        low ? number > lowest_ + within + kTurn / 2 : number < lowest_ + within - kTurn / 2;
    if (!side.bit(across_[static_cast<std::size_t>(scales > 0 ? 2 * scales : 0)], across)) {
      return turns;
    }
    return turns + (low ? -kTurn : kTurn);
  }

 private:
  static double floor(double turns) {
    if (!(std::fabs(turns) < kMost)) return 0;
    const auto whole = static_cast<double>(static_cast<long>(turns));
    return whole > turns ? whole - 1 : whole;
  }

  static constexpr double kTurn = 360;
  static constexpr double kMost = 1e5;
  static constexpr int kReach = 16;  // scales

  double lowest_;
  std::array<Bit, std::size_t{2} * kReach> across_;  // by how many half scales away the edge is
};

}  // namespace mocapress::exact
