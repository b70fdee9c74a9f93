// The outputs of the network (exact/network.hpp) made to fit the clip: two weighted sums of what
// the network's outputs are made of, and of its inputs, are added to them. Their weights are 0 at
// first and follow each number's code length under a Student-t distribution by small steps.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "numbers/lanes.hpp"

namespace mocapress::exact {

class Tuning {
 public:
  static constexpr std::size_t kFeatures = 112;

  struct Sums {
    double move;   // in spans
    double scale;  // logarithm
  };

  // The sums of a number's features, of which those that are not given are 0.
  Sums tell(std::span<const double> features);
  // The number is known: `error`, from its prediction, in widths of the distribution.
  void learn(double error);

 private:
  static constexpr std::size_t kBlocks = kFeatures / kLanes;
  using Row = std::array<Block, kBlocks>;

  Row features_{};
  Row moves_{};
  Row scales_{};
};

}  // namespace mocapress::exact
