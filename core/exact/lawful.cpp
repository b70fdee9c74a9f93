#include "exact/lawful.hpp"

#include <algorithm>
#include <cmath>

namespace mocapress::exact {
namespace {

constexpr double kFarthest = 1e5;  // degrees; beyond it whole turns are no longer counted

double nearest_turn(double angle, double to) {
  const double turns = (to - angle) / 360;
  if (!(std::fabs(turns) < kFarthest)) return to;
  return angle + 360 * static_cast<double>(static_cast<long>(turns + (turns < 0 ? -0.5 : 0.5)));
}

}  // namespace

Lawful::Lawful(const Coupling& coupling, std::span<const Column> columns)
    : coupling_(coupling), law_(static_cast<LawKind>(coupling.kind)) {
  for (const Column& column : columns) {
    units_.push_back({std::ldexp(1.0, column.exponent), std::ldexp(1.0, -column.exponent)});
  }
  if (coupling.kind == Joint::kKind) joint_.emplace(coupling.sources.size(), coupling.parameters);
}

void Lawful::predict(std::size_t channel, const double* levels, const double* last, double* moves) {
  const auto found = std::ranges::find(coupling_.targets, channel);
  const auto target = static_cast<std::size_t>(found - coupling_.targets.begin());
  const double before = last[channel];
  const double now =
      sane(told(target, levels, before * units_[channel].per_level) * units_[channel].level);
  moves[0] = now - before;
  const double missed = seen_ > 0 ? before - told_[target] : 0;
  moves[1] = moves[0] + missed;
  moves[2] = moves[1] + (seen_ > 1 ? missed - missed_[target] : 0);
  told_[target] = now;
  missed_[target] = missed;
  if (target + 1 == coupling_.targets.size()) seen_ = std::min(seen_ + 1, 2);
}

// A target in degrees.
double Lawful::told(std::size_t target, const double* levels, double before) {
  std::array<double, kLawSources> sources{};
  if (target == 0) {
    for (std::size_t i = 0; i < coupling_.sources.size(); ++i) {
      sources[i] = std::clamp(degrees(coupling_.sources[i], levels), -kFarthest, kFarthest);
    }
  } else {
    known_[target - 1] = degrees(coupling_.targets[target - 1], levels);
  }
  if (joint_) {
    const auto [one, other, looseness] = joint_->angles(sources.data(), before);
    looseness_ = 1 + looseness;
    const double near = nearest_turn(one, before);
    const double near_too = nearest_turn(other, before);
    return std::fabs(near - before) <= std::fabs(near_too - before) ? near : near_too;
  }
  if (target == 0) law_.begin(sources.data());
  return nearest_turn(law_.predict(target, known_.data()), before);
}

}  // namespace mocapress::exact
