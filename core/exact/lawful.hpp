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
  // `levels` are those of this frame and of the last one, by channels.
  void predict(std::size_t channel, const double* levels, const double* last, double* moves);

 private:
  double told(std::size_t target, const double* levels, double before);
  double degrees(std::size_t channel, const double* levels) const {
    return levels[channel] * units_[channel].per_level;
  }

  Coupling coupling_;
  struct Unit {
    double level;      // from degrees to levels
    double per_level;  // and back
  };

  std::vector<Unit> units_;
  Law law_;
  std::optional<Joint> joint_;
  std::array<double, kLawTargets> known_{};
  std::array<double, kLawTargets> told_{};    // of the last frame
  std::array<double, kLawTargets> missed_{};  // by which it was off in the frame before that
  double looseness_ = 1;
  int seen_ = 0;
};

}  // namespace mocapress::exact
