// Every channel by its own past: a chain over its last three first differences and this one, for
// all channels at once.
#pragma once

#include <cstddef>

#include "exact/expert.hpp"
#include "exact/parallel_chains.hpp"
#include "numbers/lanes.hpp"

namespace mocapress::exact {

class OwnChains {
 public:
  explicit OwnChains(std::size_t channels);

  // The frames before this one are known.
  void begin(const Frames& frames);
  // A channel's move since the last frame.
  double move(std::size_t channel) const { return moves_[channel]; }
  // This frame is known.
  void learn(const Frames& frames);

 private:
  void see(const Frames& frames, std::size_t age);

  ParallelChains chains_;
  Lanes predictions_;
  Lanes moves_;
  Lanes usual_;
  Lanes weights_;
};

}  // namespace mocapress::exact
