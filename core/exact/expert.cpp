#include "exact/expert.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mocapress::exact {
namespace {

// Products of angles are scaled to be about as large as angles.
constexpr double kProductScale = 1.0 / 30;

}  // namespace

Frames::Frames(std::size_t channels)
    : moves_(channels, 0), bends_(channels, 0), guesses_(channels, 0) {
  rows_.fill(Lanes(channels, 0));
}

void Frames::next() { std::rotate(rows_.begin(), rows_.end() - 1, rows_.end()); }

Expert::Expert(ExpertPlan plan, std::size_t channels)
    : plan_(std::move(plan)),
      chain_(plan_.variables.size(), plan_.fading, kChainRidge),
      target_(channels, -1),
      values_(plan_.variables.size()),
      usual_(plan_.variables.size(), kChainRidge) {
  for (std::size_t i = 0; i < plan_.variables.size(); ++i) {
    const Variable& variable = plan_.variables[i];
    if (variable.kind == Variable::Kind::target) {
      target_[variable.channels[0]] = static_cast<int>(i);
    }
  }
}

double Expert::value(const Variable& variable, const Frames& frames) const {
  switch (variable.kind) {
    case Variable::Kind::known:
    case Variable::Kind::target:
      return plan_.order == 1 ? frames.move(variable.channels[0])
                              : frames.bend(variable.channels[0]);
    case Variable::Kind::past:
      return frames.difference(variable.channels[0], plan_.order, variable.age);
    case Variable::Kind::guess:
      return frames.guess(variable.channels[0]);
    case Variable::Kind::product:
      break;
  }
  double products[3] = {};
  for (std::size_t age = 0; age <= static_cast<std::size_t>(plan_.order); ++age) {
    double product = 1 / kProductScale;
    for (int i = 0; i < variable.count; ++i) {
      product *= frames.level(variable.channels[i], age) * kProductScale;
    }
    products[age] = product;
  }
  const double first = products[0] - products[1];
  return plan_.order == 1 ? first : first - (products[1] - products[2]);
}

void Expert::see_until(std::size_t end, const Frames& frames) {
  if (seen_ >= end) return;
  for (std::size_t i = seen_; i < end; ++i) values_[i] = value(plan_.variables[i], frames);
  chain_.see(seen_, std::span(values_).subspan(seen_, end - seen_));
  seen_ = end;
}

void Expert::begin() {
  chain_.begin();
  seen_ = 0;
}

double Expert::predict(std::size_t channel, const Frames& frames) {
  const auto variable = static_cast<std::size_t>(target_[channel]);
  see_until(variable, frames);
  const double extrapolated = plan_.order == 1
                                  ? frames.level(channel, 1)
                                  : frames.level(channel, 1) + frames.difference(channel, 1, 1);
  return extrapolated + chain_.predicted(variable);
}

double Expert::weigh(const Frames& frames) {
  see_until(plan_.variables.size(), frames);
  double unusual = 0;
  int targets = 0;
  for (std::size_t i = 0; i < plan_.variables.size(); ++i) {
    if (plan_.variables[i].kind != Variable::Kind::target) continue;
    const double innovation = chain_.innovation(i);
    unusual += unusualness(innovation * innovation, usual_[i]);
    ++targets;
  }
  return weight_of_frame(unusual, std::max(targets, 1));
}

}  // namespace mocapress::exact
