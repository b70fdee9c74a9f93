// How many steps a number lies away from its prediction, coded by tables that never change.
//
// Distances are counted in 2^shift steps and cut into buckets: one by one below 16, then two
// buckets per octave up to 2048. A table of the chances of Student's t distribution belongs to each
// class of scales, a quarter of an octave apart; above eight steps the classes repeat with the next
// shift.
#pragma once

#include <array>
#include <cstdint>

#include "coding/sides.hpp"

namespace mocapress::exact {

// Logarithms to the base 2, in 1/256.
inline constexpr int kOctave = 256;

class Distances {
 public:
  static constexpr int kSymbols = 64;  // two for each bucket: up and down
  static constexpr int kClasses = 24;  // from an eighth of a step to eight steps
  static constexpr unsigned kOffLine = kSymbols - 1;

  // A distance as it stands in the stream; `scale` is the logarithm of the scale in steps.
  // `on_line` false: there is no distance, the number follows by itself.
  template <class Side>
  static std::int64_t code(Side& side, int scale, std::int64_t distance, bool& on_line);
};

}  // namespace mocapress::exact
