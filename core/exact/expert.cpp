#include "exact/expert.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mocapress::exact {
namespace {

constexpr double kRidge = 1e-2;
constexpr double kUsualRate = 0.02;
constexpr double kMostUnusual = 100;
// Products of angles are scaled to be about as large as angles.
constexpr double kProductScale = 1.0 / 30;

}  // namespace

Frames::Frames(std::size_t channels) : levels_(channels * kKept), guesses_(channels) {
  for (std::size_t age = 0; age < rows_.size(); ++age) rows_[age] = age * channels;
}

void Frames::next() { std::rotate(rows_.begin(), rows_.end() - 1, rows_.end()); }

void Frames::set(std::size_t channel, double level) { levels_[rows_[0] + channel] = level; }

Expert::Expert(ExpertPlan plan, std::size_t channels)
    : plan_(std::move(plan)),
      chain_(plan_.variables.size(), plan_.fading, kRidge),
      target_(channels, -1),
      usual_(plan_.variables.size(), kRidge) {
  for (std::size_t i = 0; i < plan_.variables.size(); ++i) {
    const Variable& variable = plan_.variables[i];
    if (variable.kind == Variable::Kind::target) {
      target_[variable.channels[0]] = static_cast<int>(i);
    }
  }
}

double Expert::value(const Variable& variable, const Frames& frames) const {
  if (variable.kind == Variable::Kind::guess) return frames.guess(variable.channels[0]);
  if (variable.kind != Variable::Kind::product) {
    return frames.difference(variable.channels[0], plan_.order, variable.age);
  }
  double products[3] = {};
  for (int age = 0; age <= plan_.order; ++age) {
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
  for (; seen_ < end; ++seen_) chain_.see(seen_, value(plan_.variables[seen_], frames));
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

void Expert::learn(const Frames& frames) {
  see_until(plan_.variables.size(), frames);
  // A frame that is further off than usual counts for less.
  double unusual = 0;
  int targets = 0;
  for (std::size_t i = 0; i < plan_.variables.size(); ++i) {
    if (plan_.variables[i].kind != Variable::Kind::target) continue;
    const double square = chain_.innovation(i) * chain_.innovation(i);
    unusual += std::min(square / (usual_[i] + 1e-12), kMostUnusual);
    usual_[i] += kUsualRate * (square - usual_[i]);
    ++targets;
  }
  chain_.learn(1 / std::sqrt(unusual / std::max(targets, 1) + 0.05));
}

}  // namespace mocapress::exact
