#include "exact/blend.hpp"

#include <algorithm>

namespace mocapress::exact {
namespace {

constexpr std::array kFadings = {0.94, 0.985, 0.998};
constexpr double kRidge = 1;
constexpr double kErrorRate = 0.05;
constexpr double kFarthest = 6;  // an error beyond so many scales counts as one of them

}  // namespace

Blend::Blend(std::size_t predictors, std::size_t from, std::size_t to, std::size_t memories)
    : predictors_(predictors), from_(from), to_(to) {
  if (predictors > 1) {
    for (std::size_t k = 0; k < memories; ++k) {
      chains_.emplace_back(predictors, kFadings[k], kRidge);
    }
  }
  errors_.fill(1);
}

double Blend::predict(std::span<const double> predictions) {
  mean_ = 0;
  for (std::size_t i = from_; i < to_; ++i) mean_ += predictions[i];
  mean_ /= static_cast<double>(to_ - from_);
  if (chains_.empty()) return mean_;
  double weights = 0;
  double sum = 0;
  for (std::size_t k = 0; k < chains_.size(); ++k) {
    // The first one's distance follows from the others.
    Chain& chain = chains_[k];
    chain.begin();
    for (std::size_t i = 1; i < predictors_; ++i) chain.see(i - 1, predictions[i] - mean_);
    guesses_[k] = chain.predicted(predictors_ - 1);
    const double square = errors_[k] * errors_[k] + 1e-12;
    const double weight = 1 / (square * square);
    weights += weight;
    sum += weight * guesses_[k];
  }
  return mean_ + sum / weights;
}

void Blend::learn(double value, double scale) {
  for (std::size_t k = 0; k < chains_.size(); ++k) {
    const double error = (value - mean_ - guesses_[k]) / scale;
    errors_[k] += kErrorRate * (std::min(error * error, 25.0) - errors_[k]);
    // A wild value moves the weights no further than the farthest one that is likely.
    const double near = std::clamp(error, -kFarthest, kFarthest) * scale + guesses_[k];
    chains_[k].see(predictors_ - 1, near);
    chains_[k].learn(1 / (scale * scale));
  }
}

}  // namespace mocapress::exact
