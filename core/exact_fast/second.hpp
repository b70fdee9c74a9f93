// A second prediction of each channel, from its own past, blended with the first one; and, in the
// last stage, what the last residuals still tell.
#pragma once

#include <cstddef>

#include "exact/blend.hpp"
#include "exact/expert.hpp"
#include "exact/last.hpp"
#include "exact/own.hpp"

namespace mocapress::exact {

template <bool kLastStage>
class Second {
 public:
  explicit Second(std::size_t channels)
      : own_(channels), blends_(channels, 2, kOneBlend), last_(channels, {}) {}

  // A frame: begin, for every channel blend, moved_by_past and see, then learn.
  void begin(const Frames& frames) {
    own_.begin(frames);
    if (kLastStage) last_.begin();
  }
  // Of how far the first prediction has the channel move.
  double blend(std::size_t channel, double move) {
    return blended_ = blends_.predict_pair(channel, move, own_.move(channel));
  }
  // `scale`: how far off the value is to be expected.
  double moved_by_past(std::size_t channel, double scale) {
    return kLastStage ? last_.move_by_past(channel, scale) : 0;
  }
  // `moved`: whether moved_by_past was asked for.
  void see(std::size_t channel, double move, double scale, bool moved) {
    blends_.see(channel, move, scale);
    if (kLastStage && moved) last_.see(channel, move - blended_);
  }
  void learn(const Frames& frames) {
    own_.learn(frames);
    blends_.learn();
    if (kLastStage) last_.learn();
  }

 private:
  OwnChains own_;
  Blends blends_;
  LastStage last_;
  double blended_ = 0;  // of the last channel
};

}  // namespace mocapress::exact
