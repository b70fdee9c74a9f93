// One prediction from many.
//
// The predictors' distances from a mean are the variables of a chain whose last variable is the
// value's distance: least squares over a fading past, each frame counting by how precise it is.
// Channels with equally many predictors learn together.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "exact/parallel_chains.hpp"
#include "numbers/lanes.hpp"

namespace mocapress::exact {

class Blends {
 public:
  struct Plan {
    std::span<const double> fadings;  // of each memory
    double ridge;                     // how much the mean is trusted at first
  };

  Blends(std::size_t channels, std::size_t predictors, const Plan& plan);

  // Of the predictions, only those from <= i < to make up the mean, which is trusted at first.
  double predict(std::size_t channel, std::span<const double> predictions, std::size_t from,
                 std::size_t to);
  // The same of two predictors and one memory.
  double predict_pair(std::size_t channel, double one, double other) {
    Memory& memory = memories_[0];
    const double mean = (one + other) * 0.5;
    const double apart = other - mean;
    means_[channel] = mean;
    memory.chains.see(channel, 0, apart);
    const Block* weight = memory.chains.column(channel / kLanes, 0);
    memory.guesses[channel] = reinterpret_cast<const double*>(weight)[channel % kLanes] * apart;
    return mean + memory.guesses[channel];
  }
  // `scale`: how far off the value was to be expected.
  void see(std::size_t channel, double value, double scale) {
    values_[channel] = value;
    scales_[channel] = scale;
  }
  // All channels' values have been seen.
  void learn();

  template <class Visit>
  void visit(std::size_t channel, Visit&& each) {
    for (auto& memory : memories_) memory.chains.visit(channel, each);
  }

 private:
  struct Memory {
    ParallelChains chains;
    Lanes guesses;
    Lanes errors;  // running mean of the squared error
    Lanes weights;
  };

  std::size_t predictors_;
  std::array<double, ParallelChains::kMost + 1> shares_;
  std::vector<Memory> memories_;
  Lanes means_;
  Lanes values_;
  Lanes scales_;
};

inline constexpr std::array kOneFading = {0.94};
inline constexpr Blends::Plan kOneBlend = {kOneFading, 1};  // of all lower levels

}  // namespace mocapress::exact
