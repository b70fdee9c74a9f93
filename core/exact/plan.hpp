// Which predictors a level has.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "exact/blend.hpp"
#include "exact/codec.hpp"
#include "exact/expert.hpp"
#include "exact/limbs.hpp"

namespace mocapress::exact {

// Whether there are guesses from the skeleton's geometry.
bool knows_skeleton(std::span<const Column> columns, int level);

// One of the predictors of some or all channels.
struct Predictor {
  enum class Kind { expert, limbs, own } kind;
  std::size_t index = 0;  // among the experts or the limbs
};

struct Plans {
  std::vector<ExpertPlan> experts;
  std::vector<LimbsPlan> limbs;
  std::vector<Predictor> order;  // in which they are blended

  void add(ExpertPlan plan) {
    order.push_back({Predictor::Kind::expert, experts.size()});
    experts.push_back(std::move(plan));
  }
  void add(const LimbsPlan& plan) {
    order.push_back({Predictor::Kind::limbs, limbs.size()});
    limbs.push_back(plan);
  }
};

// How predictors are blended; `known`: whether there are guesses.
Blends::Plan blend_plan(bool known, int level);

// Of the columns that are predicted.
Plans plans(std::span<const Column> columns, std::span<const Coupling> couplings, int level);

}  // namespace mocapress::exact
