// The last stage of a prediction: what the residuals still tell.
//
// Residuals are not white, and a blend does not use all that its predictors tell. A weighted sum of
// a channel's last residuals and of its predictors' distances from the blend moves the prediction
// once more. The weights follow the error by small steps; each channel's are pulled towards those
// that all channels share.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "exact/expert.hpp"
#include "numbers/lanes.hpp"

namespace mocapress::exact {

class LastStage {
 public:
  static constexpr std::size_t kPast = 8;  // residuals
  static constexpr std::size_t kInputs = kPast + kNoSlot;
  // By slots: how far the predictors are from the blend.
  using Apart = std::array<double, kNoSlot + 1>;

  // `slots`: those of the predictors that there are.
  LastStage(std::size_t channels, const std::vector<std::size_t>& slots);

  // A frame: begin, for every channel that takes part move, move_by_past and see, then learn.
  void begin();
  // How far the predictors move the blend.
  double move(std::size_t channel, const Apart& apart);
  // How far the past moves it; `span`: how far off the value is to be expected.
  double move_by_past(std::size_t channel, double span) {
    spans_[channel] = span;
    return sums_[channel] * span;
  }
  // `error`: the value minus the blend.
  void see(std::size_t channel, double error) { errors_[channel] = error; }
  void learn();

  // That of the last frame is the first, in spans.
  double residual(std::size_t channel, std::size_t i) const { return inputs_[i][channel]; }

 private:
  void follow_input(std::size_t input);

  std::vector<std::size_t> used_;  // inputs
  std::array<double, kInputs> shared_;
  std::array<Lanes, kInputs> weights_;
  std::array<Lanes, kInputs> inputs_;  // residuals, then what is apart
  Lanes sums_;                         // of the past, in spans
  Lanes moves_;                        // by the predictors
  Lanes spans_;
  Lanes errors_;
  Lanes residuals_;
};

}  // namespace mocapress::exact
