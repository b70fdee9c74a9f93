#include "exact/spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "numbers/arithmetic.hpp"
#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kFastRate = 0.4;
constexpr double kMiddleRate = 0.12;
constexpr double kSlowRate = 0.03;
constexpr double kStep = 0.003;
constexpr double kFreedom = 4;
constexpr double kFirstRate = 0.2;  // from channel to channel, in the first frame
constexpr double kTiny = 1e-3;      // levels
constexpr double kFarthest = 20;    // an error beyond so many scales counts as one of them
constexpr double kMostFeature = 3;
constexpr double kMostWeight = 4;
// Found by training on many clips; any channel moves on from there.
constexpr std::array kFirstWeights = {-0.1, 0.4, 0.2, 0.5, 0.15, 0.03};

enum Feature : std::size_t { kOne, kFast, kSlow, kActivity, kDisagreement, kLast };

template <class Number>
MOCAPRESS_IN_PLACE Number follow(Number mean, Number value, double rate) {
  return mean + rate * (value - mean);
}

// NaN becomes -most.
double bounded(double value, double most) {
  return value > most ? most : value > -most ? value : -most;
}

MOCAPRESS_IN_PLACE Block bounded(Block value, double most) {
  const Block above = value > -most ? value : -most + Block{};
  return value > most ? most + Block{} : above;
}

MOCAPRESS_VECTOR_CLONES
void look_back_all(const Block* fast, const Block* middle, const Block* slow, const Block* floors,
                   const Block* weight_of_one, const Block* weights_fast, const Block* weights_slow,
                   Block* features_fast, Block* features_slow, Block* middles, Block* sums,
                   std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b) {
    middles[b] = natural_log(middle[b] + floors[b]);
    features_fast[b] = bounded(natural_log(fast[b] + floors[b]) - middles[b], kMostFeature);
    features_slow[b] = bounded(natural_log(slow[b] + floors[b]) - middles[b], kMostFeature);
    sums[b] = ((middles[b] + weight_of_one[b]) + weights_fast[b] * features_fast[b]) +
              weights_slow[b] * features_slow[b];
  }
}

// From an error's square, in scales, to the slope of its code length, in place.
MOCAPRESS_VECTOR_CLONES
void slope_all(Block* squares, std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b) {
    squares[b] = bounded((kFreedom + 1) * squares[b] / (kFreedom + squares[b]) - 1, 2);
  }
}

MOCAPRESS_VECTOR_CLONES
void follow_slope(Block* weights, const Block* features, const Block* slopes, std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b) {
    weights[b] = bounded(weights[b] + kStep * slopes[b] * features[b], kMostWeight);
  }
}

MOCAPRESS_VECTOR_CLONES
void follow_errors(Block* fast, Block* middle, Block* slow, const Block* errors,
                   const Block* scales, double most_scales, double rate, std::size_t blocks) {
  const double fast_rate = std::max(kFastRate, rate);
  const double middle_rate = std::max(kMiddleRate, rate);
  const double slow_rate = std::max(kSlowRate, rate);
  for (std::size_t b = 0; b < blocks; ++b) {
    const Block size = errors[b] < 0 ? -errors[b] : errors[b];
    const Block most = most_scales * scales[b];
    const Block cut = most < size ? most : size;
    fast[b] = follow(fast[b], cut, fast_rate);
    middle[b] = follow(middle[b], cut, middle_rate);
    slow[b] = follow(slow[b], cut, slow_rate);
  }
}

}  // namespace

Spreads::Spreads(std::size_t channels)
    : fast_(channels, 0),
      middle_(channels, 0),
      slow_(channels, 0),
      floors_(channels, 1),
      middles_(channels, 0),
      sums_(channels, 0),
      scales_(channels, 1),
      inverses_(channels, 1),
      errors_(channels, 0),
      squares_(channels, 0),
      last_(channels, 0) {
  for (std::size_t i = 0; i < kFeatures; ++i) {
    weights_[i] = Lanes(channels, kFirstWeights[i]);
    features_[i] = Lanes(channels, i == kOne ? 1 : 0);
  }
}

void Spreads::begin() {
  if (seen_ == 0) return;
  look_back_all(fast_.blocks(), middle_.blocks(), slow_.blocks(), floors_.blocks(),
                weights_[kOne].blocks(), weights_[kFast].blocks(), weights_[kSlow].blocks(),
                features_[kFast].blocks(), features_[kSlow].blocks(), middles_.blocks(),
                sums_.blocks(), floors_.count_blocks());
  std::swap(features_[kLast], last_);
}

void Spreads::look_back(std::size_t c, double floor) {
  const double middle = natural_log(middle_[c] + floor);
  const double fast = bounded(natural_log(fast_[c] + floor) - middle, kMostFeature);
  const double slow = bounded(natural_log(slow_[c] + floor) - middle, kMostFeature);
  sums_[c] = ((middle + weights_[kOne][c]) + weights_[kFast][c] * fast) + weights_[kSlow][c] * slow;
  middles_[c] = middle;
  features_[kFast][c] = fast;
  features_[kSlow][c] = slow;
  floors_[c] = floor;
}

double Spreads::scale(std::size_t c, double disagreement, double floor) {
  if (seen_ == 0) {
    floors_[c] = floor;
    return scales_[c] = std::max(natural_exp(first_), floor);
  }
  if (floor != floors_[c]) look_back(c, floor);
  const double apart = bounded(natural_log(disagreement + floor) - middles_[c], kMostFeature);
  features_[kActivity][c] = activity_;
  features_[kDisagreement][c] = apart;
  const double sum =
      ((sums_[c] + weights_[kActivity][c] * activity_) + weights_[kDisagreement][c] * apart) +
      weights_[kLast][c] * features_[kLast][c];
  const double scale = std::max(natural_exp(bounded(sum, 600)), 0.2 * floor);
  inverses_[c] = 1 / scale;
  return scales_[c] = scale;
}

void Spreads::see(std::size_t c, double error) {
  errors_[c] = error;
  if (seen_ == 0) {
    first_ = follow(first_, natural_log(std::fabs(error) + kTiny), kFirstRate);
    return;
  }
  const double relative = error * inverses_[c];
  const double square = relative * relative;
  squares_[c] = square;
  last_[c] = std::clamp(natural_log(std::fabs(relative) + 0.1) + 0.5, -2.0, 3.0);
  activity_ = follow(activity_, last_[c], 0.15);
}

void Spreads::learn() {
  const std::size_t blocks = errors_.count_blocks();
  if (seen_ > 0) {
    slope_all(squares_.blocks(), blocks);
    for (std::size_t i = 0; i < kFeatures; ++i) {
      follow_slope(weights_[i].blocks(), features_[i].blocks(), squares_.blocks(), blocks);
    }
  }
  ++seen_;
  const double most = seen_ == 1 ? std::numeric_limits<double>::infinity() : kFarthest;
  follow_errors(fast_.blocks(), middle_.blocks(), slow_.blocks(), errors_.blocks(),
                scales_.blocks(), most, 1.0 / seen_, blocks);
}

}  // namespace mocapress::exact
