// Every channel by those before it in its limb, which is a block of channels, by the limb before,
// and by the first channels, the root, which moves everything: few enough to be learned within a
// second. Each limb has a chain (exact/chain.hpp); all of them learn a frame together.
#pragma once

#include <cstddef>

#include "exact/expert.hpp"
#include "exact/parallel_chains.hpp"
#include "numbers/lanes.hpp"

namespace mocapress::exact {

struct LimbsPlan {
  std::size_t slot;
  int order;  // of the differences that are the chains' variables
  double fading;
};

inline constexpr std::size_t kLimb = 6;  // channels

class Limbs {
 public:
  Limbs(const LimbsPlan& plan, std::size_t channels);

  std::size_t slot() const { return plan_.slot; }

  // A frame: begin, for every channel in order predict, then learn.
  void begin();
  // The level of a channel; those before it are known.
  double predict(std::size_t channel, const Frames& frames);
  void learn(const Frames& frames);

 private:
  double value(std::size_t channel, const Frames& frames) const {
    return plan_.order == 1 ? frames.move(channel) : frames.bend(channel);
  }
  std::size_t known_before(std::size_t limb) const {
    return limb == 0 ? 0 : limb == 1 ? kLimb : 2 * kLimb;
  }
  double see(std::size_t variable, double value);
  void see_target(std::size_t channel, const Frames& frames);
  void enter(std::size_t limb, const Frames& frames);
  void see_root(const Frames& frames);

  LimbsPlan plan_;
  std::size_t channels_;
  std::size_t limb_ = 0;   // that of the channel predicted last
  std::size_t first_ = 0;  // its first channel
  std::size_t known_ = 0;  // variables before its own
  std::size_t most_;       // variables of a chain
  ParallelChains chains_;
  // Of eight limbs: for each variable, or for each of a limb's channels.
  Blocks predictions_;
  Blocks innovations_;
  Blocks usual_;  // running means of their squares
  Lanes targets_;
  Lanes weights_;
};

}  // namespace mocapress::exact
