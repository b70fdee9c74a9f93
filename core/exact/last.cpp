#include "exact/last.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kOwnRate = 0.003;
constexpr double kSharedRate = 2e-4;
constexpr double kPull = 0.01;
constexpr double kMostInput = 4;  // spans
constexpr double kMostError = 3;
// Found by training on many clips.
constexpr std::array<double, LastStage::kInputs> kFirstWeights = {0.02,  -0.118, 0.009, 0.018,
                                                                  0.024, 0.042,  0.024, 0.029};

MOCAPRESS_IN_PLACE Block cut(Block value, Block most) {
  const Block above = value > -most ? value : -most;
  return value > most ? most : above;
}

MOCAPRESS_VECTOR_CLONES
void add_products(const Block* a, const Block* b, Block* sums, std::size_t blocks) {
  for (std::size_t i = 0; i < blocks; ++i) sums[i] += a[i] * b[i];
}

// From the errors of the blends to those of the moved ones, and to residuals, all in spans.
MOCAPRESS_VECTOR_CLONES
void judge(const Block* sums, const Block* moves, const Block* spans, Block* errors,
           Block* residuals, std::size_t blocks) {
  for (std::size_t i = 0; i < blocks; ++i) {
    const Block moved = moves[i] + sums[i] * spans[i];
    residuals[i] = cut(errors[i] / spans[i], kMostInput + Block{});
    errors[i] = cut((errors[i] - moved) / spans[i], kMostError + Block{});
  }
}

MOCAPRESS_VECTOR_CLONES
void to_spans(Block* inputs, const Block* spans, std::size_t blocks) {
  for (std::size_t i = 0; i < blocks; ++i) {
    inputs[i] = cut(inputs[i] / spans[i], kMostInput + Block{});
  }
}

// Gives the sums of errors times inputs, too, of every eighth channel each.
MOCAPRESS_VECTOR_CLONES
void follow(const Block* errors, const Block* inputs, double shared, Block* weights, Block* sums,
            std::size_t blocks) {
  *sums = Block{};
  for (std::size_t i = 0; i < blocks; ++i) {
    const Block slope = errors[i] * inputs[i];
    weights[i] = (weights[i] + kOwnRate * slope) + kPull * (shared - weights[i]);
    *sums += slope;
  }
}

}  // namespace

LastStage::LastStage(std::size_t channels, const std::vector<std::size_t>& slots)
    : used_(kPast),
      shared_(kFirstWeights),
      sums_(channels, 0),
      moves_(channels, 0),
      spans_(channels, 1),
      errors_(channels, 0),
      residuals_(channels, 0) {
  std::iota(used_.begin(), used_.end(), 0);
  for (const std::size_t slot : slots) used_.push_back(kPast + slot);
  for (std::size_t i = 0; i < kInputs; ++i) {
    weights_[i] = Lanes(channels, kFirstWeights[i]);
    inputs_[i] = Lanes(channels, 0);
  }
}

void LastStage::begin() {
  std::fill_n(sums_.data(), sums_.count_blocks() * kLanes, 0.0);
  for (std::size_t i = 0; i < kPast; ++i) {
    add_products(weights_[i].blocks(), inputs_[i].blocks(), sums_.blocks(), sums_.count_blocks());
  }
}

// Here what is apart is cut by the span of the last frame, which is known early.
double LastStage::move(std::size_t channel, const Apart& apart) {
  const double most = kMostInput * spans_[channel];
  double sum = 0;
  for (std::size_t k = kPast; k < used_.size(); ++k) {
    const std::size_t i = used_[k];
    const double far = apart[i - kPast];
    const double above = far > -most ? far : -most;
    inputs_[i][channel] = far > most ? most : above;
    sum += weights_[i][channel] * inputs_[i][channel];
  }
  moves_[channel] = sum;
  return sum;
}

void LastStage::follow_input(std::size_t i) {
  Block sums;
  follow(errors_.blocks(), inputs_[i].blocks(), shared_[i], weights_[i].blocks(), &sums,
         errors_.count_blocks());
  double total = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) total += sums[lane];
  shared_[i] += kSharedRate * total;
}

void LastStage::learn() {
  const std::size_t blocks = errors_.count_blocks();
  judge(sums_.blocks(), moves_.blocks(), spans_.blocks(), errors_.blocks(), residuals_.blocks(),
        blocks);
  for (const std::size_t i : used_) {
    if (i >= kPast) to_spans(inputs_[i].blocks(), spans_.blocks(), blocks);
    follow_input(i);
  }
  std::swap(inputs_[kPast - 1], residuals_);
  std::rotate(inputs_.begin(), inputs_.begin() + kPast - 1, inputs_.begin() + kPast);
}

}  // namespace mocapress::exact
