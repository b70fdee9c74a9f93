// The laws and joints of a clip, for the channels that they tell.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "exact/choice.hpp"
#include "exact/codec.hpp"
#include "exact/expert.hpp"
#include "exact/lawful.hpp"

namespace mocapress::exact {

// A channel that a law tells: of the law's predictions and another one, the one that is nearest.
class ToldByLaw {
 public:
  explicit ToldByLaw(Lawful& law) : law_(&law) {}

  // How far the channel moves.
  double choose(std::size_t channel, const Frames& frames, double other) {
    law_->predict(channel, frames.row(0).data(), frames.row(1).data(), moves_.data());
    moves_.back() = other;
    return moves_[choice_.nearest()];
  }

  // `scale`: how far off it was to be expected.
  void learn(double move, double scale) {
    constexpr double kFarthest = 20;  // scales
    choice_.learn(moves_.data(), move, kFarthest * scale);
  }

 private:
  static constexpr std::size_t kCount = Lawful::kPredictions + 1;

  Lawful* law_;
  std::array<double, kCount> moves_{};
  Choice<kCount> choice_;
};

class ToldByLaws {
 public:
  explicit ToldByLaws(const Clip& clip) : of_(clip.columns.size(), -1) {
    for (const Coupling& coupling : clip.couplings) {
      if (coupling.kind == 0) continue;
      laws_.push_back(std::make_unique<Lawful>(coupling, clip.columns));
      for (const auto target : coupling.targets) {
        of_[target] = static_cast<int>(told_.size());
        told_.emplace_back(*laws_.back());
      }
    }
  }

  // Null where no law tells the channel.
  ToldByLaw* of(std::size_t channel) {
    return of_[channel] < 0 ? nullptr : &told_[static_cast<std::size_t>(of_[channel])];
  }

 private:
  std::vector<std::unique_ptr<Lawful>> laws_;
  std::vector<ToldByLaw> told_;
  std::vector<int> of_;  // by channels: the place in told_, or -1
};

}  // namespace mocapress::exact
