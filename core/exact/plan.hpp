// Which predictors a level has.
#pragma once

#include <span>
#include <vector>

#include "exact/codec.hpp"
#include "exact/expert.hpp"

namespace mocapress::exact {

// Whether there are guesses from the skeleton's geometry.
bool knows_skeleton(std::span<const Column> columns, int level);

struct Plans {
  std::vector<ExpertPlan> experts;
  std::size_t before_own;  // behind so many of them each channel's own past has its say
};

// Of the columns that are predicted.
Plans plans(std::span<const Column> columns, std::span<const Coupling> couplings, int level);

}  // namespace mocapress::exact
