// How far the next value of a channel may lie from its prediction: the scale of the distribution by
// which it is coded, learned from how far the last ones lay.
//
// ln(scale) is a weighted sum of what is known before the value: how far off the channel was lately
// (at three speeds), how far off the channels before it are in this very frame, and how much the
// predictors disagree. The weights follow the gradient of the code length under a Student-t
// distribution of four degrees of freedom. Whatever can wait is done for all channels at once.
#pragma once

#include <array>
#include <cstddef>

#include "numbers/lanes.hpp"

namespace mocapress::exact {

class Spreads {
 public:
  explicit Spreads(std::size_t channels);

  // A frame: begin, for every channel in order scale and see, then learn.
  void begin();
  // `disagreement`: mean distance of the predictors from the final prediction; `floor`: a small
  // part of the distance between neighbouring numbers.
  double scale(std::size_t channel, double disagreement, double floor);
  void see(std::size_t channel, double error);
  void learn();

  // What the scale was made of: how fast and slow errors are against the middle, the activity, the
  // disagreement, and how far off the last value was.
  using Features = std::array<double, 5>;
  Features features(std::size_t channel) const {
    Features features;
    for (std::size_t i = 0; i < features.size(); ++i) features[i] = features_[i + 1][channel];
    return features;
  }

  template <class Visit>
  void visit(std::size_t channel, Visit&& each) {
    for (auto& weights : weights_) each(weights[channel]);
  }

 private:
  static constexpr std::size_t kFeatures = 6;

  // The features that depend on nothing of this frame but the floor.
  void look_back(std::size_t channel, double floor);

  std::array<Lanes, kFeatures> weights_;
  std::array<Lanes, kFeatures> features_;
  Lanes fast_, middle_, slow_;  // running means of the error's size
  Lanes floors_;                // of this frame, or of the last one as long as it is not known
  Lanes middles_;               // logarithms
  Lanes sums_;                  // of the features that look back
  Lanes scales_;
  Lanes inverses_;
  Lanes errors_;
  Lanes squares_;        // of the errors, in scales
  Lanes last_;           // how far off the value was, against the scale
  double first_ = -1;    // in the first frame: logarithm of the errors of the channels before
  double activity_ = 0;  // the same, a running mean over the channels one after the other
  int seen_ = 0;
};

}  // namespace mocapress::exact
