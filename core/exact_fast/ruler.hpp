// The numbers of a line as whole numbers of equal steps, in one stretch of the line.
//
// A line of significant digits, decimal or binary, has a step of its own in every decade. The ruler
// takes that of the decade in which the prediction and most of what may come lie. A number of a
// lower decade lies between two marks and has a rest of a few digits, all equally likely; one of a
// higher decade lies on every tenth mark.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "coding/sides.hpp"
#include "exact/codec.hpp"
#include "exact_fast/symbols.hpp"
#include "numbers/line.hpp"

namespace mocapress::exact {

// log2 of a normal, positive number, in 1/256, linear within an octave: it needs to be the same
// everywhere, not exact.
inline int octaves(double value) {
  return static_cast<int>(std::bit_cast<std::int64_t>(value) >> 44) - 1023 * kOctave;
}

inline double from_octaves(int octaves) {
  return std::bit_cast<double>(static_cast<std::int64_t>(octaves + 1023 * kOctave) << 44);
}

class Ruler {
 public:
  explicit Ruler(const Column& column);

  // Takes the steps of the decade of a magnitude, in levels.
  void reach(double magnitude) {
    if (!(magnitude >= low_ && magnitude < high_)) move(magnitude);
  }

  double step() const { return step_; }  // in levels
  int log_step() const { return log_step_; }

  double level(double number) const { return number * unit_; }

  // The steps nearest to a prediction.
  std::int64_t near(double predicted) const {
    return printed() ? near_place(predicted) : nearest(predicted * per_step_);
  }

  // A number in steps from zero, rounded towards it.
  struct Place {
    std::int64_t steps;
    std::uint64_t rest;  // what of its magnitude the line has beyond `steps`
    bool negative;
    bool on_line;
  };
  Place place(double number) const;

  // The number at a place, its rest coded where it has one; and its level.
  template <class Side>
  double finish(Side& side, const Place& place, double& level) {
    const std::uint64_t marks = magnitude(place.steps);
    if (marks < whole_ || marks >> most_bits_ != 0) return finish_rest(side, place, level);
    const auto count = static_cast<double>(place.steps);
    level = count * step_;
    return divided_ ? count / power_ : count * power_;
  }

 private:
  static std::uint64_t magnitude(std::int64_t steps) {
    const auto bits = static_cast<std::uint64_t>(steps);
    return steps < 0 ? 0 - bits : bits;
  }

  static std::int64_t nearest(double steps) {
    constexpr double kFarthest = 0x1p60;
    if (!(steps > -kFarthest && steps < kFarthest)) return 0;
    return static_cast<std::int64_t>(steps + std::copysign(0.5, steps));
  }

  // Lines of printed floats, of which the places are the marks.
  bool printed() const { return kind_ == Line::printed32 || kind_ == Line::degrees32; }
  std::int64_t near_place(double predicted) const;

  void move(double magnitude);
  template <class Side>
  double finish_rest(Side& side, const Place& place, double& level);

  NumberLine line_;
  Line kind_;
  double unit_;  // from numbers to levels
  // Of the line: places of a decade from `origin_` on, the first of `lowest_`, `base_` apart.
  int digits_ = 0;
  int base_ = 10;
  int lowest_ = 0;
  std::int64_t origin_ = 0;
  std::int64_t per_decade_ = 0;
  std::int64_t first_ = 0;  // mark of a decade: 10^(digits - 1)
  int least_ = 0;           // decades that may be taken
  int most_ = 0;
  int most_bits_ = 53;  // of a mark: what a double holds
  // Of numbers on mark 0.
  Bit negative_;
  Bit nonzero_;
  // Of the decade taken.
  int decade_ = 0;
  double low_ = 1;
  double high_ = 0;
  double step_ = 1;
  double per_step_ = 1;
  int log_step_ = 0;
  std::uint64_t whole_ = 0;  // from this mark on, numbers have no rest
  bool divided_ = true;
  double power_ = 1;  // numbers are marks divided by this, or multiplied
};

}  // namespace mocapress::exact
