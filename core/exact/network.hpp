// A small network that moves a prediction and changes its scale once more, from what the coder
// knows of the channel, of its last frames and of the channels before it. Its weights were learned
// from many clips (benchmarks/exact_network.py) and stay as they are. All inside is whole numbers.
// Its outputs may be tuned to the clip (exact/tuning.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "exact/expert.hpp"
#include "exact/last.hpp"
#include "exact/spread.hpp"
#include "exact/tables.hpp"
#include "exact/tuning.hpp"
#include "numbers/lanes.hpp"

namespace mocapress::exact {

class Network {
 public:
  static constexpr std::size_t kInputs = 46;

  Network(std::size_t channels, bool tuned);

  // What is known of a number.
  struct Known {
    std::array<double, LastStage::kPast> residuals;  // of the last frames, in spans
    LastStage::Apart apart;                          // the predictors from the blend
    double moved;                                    // by the last stage
    double last_move;                                // of the channel, to the last frame
    double scale;
    double step;  // of the line
    Spreads::Features spread;
  };
  struct Told {
    double move;   // in spans, which are scale + step
    double scale;  // to multiply the scale by
  };

  // A frame: begin, for every channel in order tell and learn (where it takes part) and see.
  void begin();
  Told tell(std::size_t channel, const Known& known);
  // `error`: how far the value was from the prediction, in widths of the distribution.
  void learn(double error) {
    if (tuning_) tuning_->learn(error);
  }
  // `residual`: how far the value was from the blend, in spans.
  void see(std::size_t channel, double residual, double span);

  // Adds the inputs of what was told last, and what would have been right.
  void show(double right, std::vector<float>& seen) const;

 private:
  static constexpr std::size_t kBefore = 8;  // channels
  static constexpr std::size_t kFrames = 9;  // of which spans are kept

  void gather(std::size_t channel, const Known& known);
  // What the tuning works with: the last hidden layer, the inputs, 1.
  std::array<double, kHidden + kInputs + 1> features(const std::int16_t* hidden) const;

  std::array<double, kInputs> inputs_{};
  std::array<Lanes, kFrames> logs_;                  // of the spans, by age
  std::array<std::array<Lanes, kNoSlot>, 3> apart_;  // in spans, by age
  Lanes residuals_;                                  // of this frame, behind kBefore zeros
  double frames_ = 0;                                // with this one
  std::optional<Tuning> tuning_;
};

}  // namespace mocapress::exact
