#include "exact/blend.hpp"

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kErrorRate = 0.05;
constexpr double kMostSquared = 25;
constexpr double kFarthest = 6;  // an error beyond so many scales counts as one of them

// What a memory made of the values: its running error, and of each chain the last variable and the
// weight of this frame.
MOCAPRESS_VECTOR_CLONES
void judge(const Block* values, const Block* means, const Block* scales, const Block* guesses,
           Block* errors, Block* near, std::size_t stride, Block* weights, std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b, near += stride) {
    const Block error = ((values[b] - means[b]) - guesses[b]) / scales[b];
    const Block square = error * error;
    errors[b] +=
        kErrorRate * ((square > kMostSquared ? kMostSquared + Block{} : square) - errors[b]);
    // A wild value moves the weights no further than the farthest one that is likely.
    Block cut = error < -kFarthest ? -kFarthest + Block{} : error;
    cut = cut > kFarthest ? kFarthest + Block{} : cut;
    *near = cut * scales[b] + guesses[b];
    weights[b] = 1 / (scales[b] * scales[b]);
  }
}

}  // namespace

Blends::Blends(std::size_t channels, std::size_t predictors, const Plan& plan)
    : predictors_(predictors), means_(channels, 0), values_(channels, 0), scales_(channels, 1) {
  for (std::size_t i = 0; i < shares_.size(); ++i) shares_[i] = 1 / static_cast<double>(i);
  if (predictors < 2) return;
  for (const double fading : plan.fadings) {
    memories_.push_back({ParallelChains(channels, predictors, fading, plan.ridge),
                         Lanes(channels, 0), Lanes(channels, 1), Lanes(channels, 0)});
  }
}

double Blends::predict(std::size_t channel, std::span<const double> predictions, std::size_t from,
                       std::size_t to) {
  double mean = 0;
  for (std::size_t i = from; i < to; ++i) mean += predictions[i];
  mean *= shares_[to - from];
  means_[channel] = mean;
  if (memories_.empty()) return mean;
  if (memories_.size() == 1) {
    Memory& memory = memories_[0];
    for (std::size_t i = 1; i < predictors_; ++i) {
      memory.chains.see(channel, i - 1, predictions[i] - mean);
    }
    return mean + (memory.guesses[channel] = memory.chains.predicted(channel));
  }
  double weights = 0;
  double sum = 0;
  for (Memory& memory : memories_) {
    // The first one's distance follows from the others.
    for (std::size_t i = 1; i < predictors_; ++i) {
      memory.chains.see(channel, i - 1, predictions[i] - mean);
    }
    const double guess = memory.chains.predicted(channel);
    memory.guesses[channel] = guess;
    const double square = memory.errors[channel] * memory.errors[channel] + 1e-12;
    const double weight = 1 / (square * square);
    weights += weight;
    sum += weight * guess;
  }
  return mean + sum / weights;
}

void Blends::learn() {
  for (Memory& memory : memories_) {
    judge(values_.blocks(), means_.blocks(), scales_.blocks(), memory.guesses.blocks(),
          memory.errors.blocks(), memory.chains.last_values(), memory.chains.stride(),
          memory.weights.blocks(), values_.count_blocks());
    memory.chains.learn(memory.weights.blocks());
  }
}

}  // namespace mocapress::exact
