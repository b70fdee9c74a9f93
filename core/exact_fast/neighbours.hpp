// What a channel's bend (its second difference) will be, from those of the channels just before it
// in the same frame, of the first channels, and from its own last ones: a least-squares fit for
// each channel, forgetting fast, all channels at once. All of it is binary32, which costs no bytes.
#pragma once

#include <cstddef>
#include <vector>

#include "numbers/lanes.hpp"

namespace mocapress::exact {

inline constexpr std::size_t kFits = 16;  // in a vector
using Fits = float __attribute__((vector_size(kFits * sizeof(float))));

// `kOwn`: bends of the channel in the frames before. `kOthers`: channels before it. `kRoots`: the
// first channels, for those that have them not among these.
template <int kOwn, int kRoots, int kOthers>
class Neighbours {
 public:
  Neighbours(std::size_t channels, float fading);

  // The bend that is to be expected; those of the channels before are set.
  float predict(std::size_t channel) {
    if (kRoots > 0 && channel == kRoots + kOthers) see_roots();
    float sum = told_[channel];
    const float* weight = weights_of(channel) + (kOwn + kRoots) * kFits;
    const float* before = bends(0) + channel - kOthers;
    for (int i = 0; i < kOthers; ++i, weight += kFits) sum += *weight * before[i];
    return sum;
  }

  void set(std::size_t channel, float bend) { bends(0)[channel] = bend; }

  // The frame is complete: learns from it, and begins the next.
  void learn();

 private:
  static constexpr std::size_t kInputs = kOwn + kRoots + kOthers;
  static constexpr std::size_t kEntries = kInputs * (kInputs + 1) / 2;

  void see_roots();

  float* bends(std::size_t age) { return bends_.data() + age * row_ + kOthers; }
  const float* weights_of(std::size_t channel) const {
    const auto* weights = reinterpret_cast<const float*>(weights_.data());
    return weights + channel / kFits * kInputs * kFits + channel % kFits;
  }

  using Blocks = std::vector<Fits, BlockAllocator<Fits>>;

  float fading_;
  std::size_t blocks_;
  std::size_t row_;           // of bends_
  std::vector<float> bends_;  // of each age, behind zeros that stand for channels before the first
  std::vector<float> roots_;  // for each root its bend, for every channel that it is an input of
  Blocks factor_;             // of a block of channels: D, then L by columns, of the fits' L D L^T
  Blocks weights_;            // of a block: of each input
  std::vector<float> told_;   // the part of the inputs that are known early
};

}  // namespace mocapress::exact
