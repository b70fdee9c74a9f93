// A coupling by a law, as a predictor of levels.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "exact/codec.hpp"
#include "exact/expert.hpp"
#include "exact/joint.hpp"
#include "exact/law.hpp"

namespace mocapress::exact {

class Lawful {
 public:
  static constexpr std::size_t kPredictions = 3;

  Lawful(const Coupling& coupling, std::span<const Column> columns);

  // Whether the law held in the clip to within what rounding leaves.
  bool sure() const { return joint_.has_value(); }
  // How many times further off than at best the last prediction may be: of a joint, what it makes
  // of the rounding of its sources.
  double looseness() const { return looseness_; }

  // Moves of a target since the last frame, where the law is off by nothing, by as much as in the
  // last frame, and by what continues the last two. The columns before the target are known.
  void predict(std::size_t channel, const Frames& frames, double* moves);

 private:
  double told(std::size_t target, const Frames& frames, double before);
  double degrees(std::size_t channel, const Frames& frames) const {
    return frames.level(channel, 0) / units_[channel];
  }

  Coupling coupling_;
  std::vector<double> units_;
  Law law_;
  std::optional<Joint> joint_;
  std::array<double, kLawTargets> known_{};
  std::array<double, kLawTargets> told_{};    // of the last frame
  std::array<double, kLawTargets> missed_{};  // by which it was off in the frame before that
  double looseness_ = 1;
  int seen_ = 0;
};

}  // namespace mocapress::exact
