// How far the next value of a channel may lie from its prediction: the scale of the distribution by
// which it is coded, learned from how far the last ones lay.
//
// ln(scale) is a weighted sum of what is known before the value: how far off the channel was lately
// (at three speeds), how far off the channels before it are in this very frame, and how much the
// predictors disagree. The weights follow the gradient of the code length under a Student-t
// distribution of four degrees of freedom.
#pragma once

#include <array>

namespace mocapress::exact {

// What all channels of a frame share.
struct Activity {
  double level = 0;  // running mean of ln|error / scale|, over the channels one after the other
};

class Spread {
 public:
  // `disagreement`: mean distance of the predictors from the final prediction; `floor`: a small
  // part of the distance between neighbouring numbers.
  double scale(double disagreement, double floor, const Activity& activity);

  void learn(double error, Activity& activity);

  template <class Visit>
  void visit(Visit&& each) {
    for (auto& weight : weights_) each(weight);
  }

 private:
  static constexpr int kFeatures = 6;

  // Found by training on many clips; any channel moves on from there.
  std::array<double, kFeatures> weights_ = {-0.1, 0.4, 0.2, 0.5, 0.15, 0.03};
  std::array<double, kFeatures> features_{};
  double fast_ = 0;
  double middle_ = 0;
  double slow_ = 0;
  double last_ = 0;
  double scale_ = 1;
  int seen_ = 0;
};

}  // namespace mocapress::exact
