#include "exact/spread.hpp"

#include <algorithm>
#include <cmath>

#include "numbers/arithmetic.hpp"

namespace mocapress::exact {
namespace {

constexpr double kFastRate = 0.4;
constexpr double kMiddleRate = 0.12;
constexpr double kSlowRate = 0.03;
constexpr double kStep = 0.003;
constexpr double kFreedom = 4;
constexpr double kFirstScale = 1000;  // in floors
constexpr double kFarthest = 20;      // an error beyond so many scales counts as one of them

double follow(double mean, double value, double rate) { return mean + rate * (value - mean); }

// NaN becomes -most.
double bounded(double value, double most) {
  return value > most ? most : value > -most ? value : -most;
}

}  // namespace

double Spread::scale(double disagreement, double floor, const Activity& activity) {
  if (seen_ == 0) {
    scale_ = kFirstScale * floor;
    return scale_;
  }
  const double middle = natural_log(middle_ + floor);
  features_ = {1,
               bounded(natural_log(fast_ + floor) - middle, 3),
               bounded(natural_log(slow_ + floor) - middle, 3),
               activity.level,
               bounded(natural_log(disagreement + floor) - middle, 3),
               last_};
  double sum = middle;
  for (int i = 0; i < kFeatures; ++i) sum += weights_[i] * features_[i];
  scale_ = std::max(natural_exp(bounded(sum, 600)), 0.2 * floor);
  return scale_;
}

void Spread::learn(double error, Activity& activity) {
  const double relative = error / scale_;
  const double square = relative * relative;
  if (seen_ > 0) {
    const double slope = (kFreedom + 1) * square / (kFreedom + square) - 1;
    for (int i = 0; i < kFeatures; ++i) {
      weights_[i] = bounded(weights_[i] + kStep * bounded(slope, 2) * features_[i], 4);
    }
    last_ = std::clamp(natural_log(std::fabs(relative) + 0.1) + 0.5, -2.0, 3.0);
    activity.level = follow(activity.level, last_, 0.15);
  }
  ++seen_;
  const double size =
      seen_ == 1 ? std::fabs(error) : std::min(std::fabs(error), kFarthest * scale_);
  const double rate = 1.0 / seen_;
  fast_ = follow(fast_, size, std::max(kFastRate, rate));
  middle_ = follow(middle_, size, std::max(kMiddleRate, rate));
  slow_ = follow(slow_, size, std::max(kSlowRate, rate));
}

}  // namespace mocapress::exact
