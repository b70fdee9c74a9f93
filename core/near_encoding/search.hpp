// Choosing the blocks of a channel in a span: how they are cut, and their numbers.
#pragma once

#include <cstddef>
#include <vector>

#include "near/coder.hpp"

namespace mocapress::near {

// What a channel is to be in a span: of every frame a target, and what the square of an error
// costs.
struct Target {
  const double* values;
  const double* costs;
  double step;
  double bit_cost;
  bool tries_knots;  // and not only the nearest
};

struct Piece {
  Block block;
  std::vector<std::int32_t> numbers;
};

struct Cut {
  double cost = 0;
  std::vector<Piece> pieces;
  std::vector<double> curve;
};

// The cheapest cut found of a span, where the channel comes from `last`; without its cost.
Cut search(Coder& coder, std::size_t i, const Plan& plan, const Target& target, int length,
           double last);

}  // namespace mocapress::near
