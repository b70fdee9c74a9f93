// Which predictors a level has.
#pragma once

#include <span>
#include <vector>

#include "exact/codec.hpp"
#include "exact/expert.hpp"

namespace mocapress::exact {

// Whether there are guesses from the skeleton's geometry.
bool knows_skeleton(std::span<const Column> columns, int level);

inline constexpr std::size_t kNoOwn = ~std::size_t{0};

struct Plans {
  std::vector<ExpertPlan> experts;
  // Behind so many of them each channel's own past has its say, or nowhere.
  std::size_t before_own;
};

// Of the columns that are predicted.
Plans plans(std::span<const Column> columns, std::span<const Coupling> couplings, int level);

}  // namespace mocapress::exact
