// One prediction from many.
//
// The predictors' distances from a mean are the variables of a chain whose last variable is the
// value's distance: least squares over a fading past, each frame counting by how precise it is.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "exact/chain.hpp"

namespace mocapress::exact {

class Blend {
 public:
  static constexpr std::size_t kMostMemories = 3;

  // Of the predictors, only those from <= i < to make up the mean, which is trusted at first.
  // `memories`: how many pasts of different lengths to learn from, up to kMostMemories.
  Blend(std::size_t predictors, std::size_t from, std::size_t to, std::size_t memories);

  double predict(std::span<const double> predictions);
  // `scale`: how far off the value was to be expected.
  void learn(double value, double scale);

  template <class Visit>
  void visit(Visit&& each) {
    for (auto& chain : chains_) chain.visit(each);
  }

 private:
  std::size_t predictors_;
  std::size_t from_;
  std::size_t to_;
  std::vector<Chain> chains_;  // one per memory
  double mean_ = 0;
  std::array<double, kMostMemories> guesses_{};
  std::array<double, kMostMemories> errors_;  // running mean of each one's squared error
};

}  // namespace mocapress::exact
