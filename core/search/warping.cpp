#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "search/search.hpp"

namespace mocapress {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

}  // namespace

Frames::Frames(const float* values, std::size_t frames, std::size_t features)
    : count_(frames), blocks_((features + kLanes - 1) / kLanes) {
  values_.resize(count_ * blocks_ * kLanes);
  for (std::size_t f = 0; f < count_; ++f) {
    std::copy_n(values + f * features, features, values_.data() + f * blocks_ * kLanes);
  }
}

float Frames::distance(std::size_t frame, const Frames& others, std::size_t other) const {
  const float* a = values_.data() + frame * blocks_ * kLanes;
  const float* b = others.values_.data() + other * blocks_ * kLanes;
  // Sums side by side, so that the order of additions is fixed and lanes can be a vector's.
  std::array<float, kLanes> sums{};
  for (std::size_t block = 0; block < blocks_; ++block, a += kLanes, b += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float apart = a[lane] - b[lane];
      sums[lane] += apart * apart;
    }
  }
  float sum = 0;
  for (const float part : sums) sum += part;
  return std::sqrt(sum);
}

float warp(const Frames& one, const Frames& other, float limit) {
  const std::size_t rows = one.count();
  const std::size_t columns = other.count();
  if (rows == 0 || columns == 0) return kInfinite;
  const auto both = static_cast<float>(rows + columns);
  std::vector<float> above(columns, kInfinite);
  std::vector<float> now(columns, kInfinite);
  for (std::size_t i = 0; i < rows; ++i) {
    float least = kInfinite;
    for (std::size_t j = 0; j < columns; ++j) {
      const float here = one.distance(i, other, j);
      float best = i == 0 && j == 0 ? 2 * here : kInfinite;
      if (i > 0 && j > 0) best = above[j - 1] + 2 * here;
      if (i > 0) best = std::min(best, above[j] + here);
      if (j > 0) best = std::min(best, now[j - 1] + here);
      now[j] = best;
      least = std::min(least, best);
    }
    // Every path goes through this row, and no step is free of cost.
    if (least > limit * both) return kInfinite;
    std::swap(above, now);
  }
  const float cost = above[columns - 1] / both;
  return cost > limit ? kInfinite : cost;
}

Matches find_stretches(const Frames& wanted, const Frames& motion, bool damped) {
  const std::size_t rows = wanted.count();
  const std::size_t columns = motion.count();
  Matches matches{std::vector<float>(columns, kInfinite), std::vector<std::int32_t>(columns, 0)};
  if (rows == 0) return matches;
  // The row that is made, and the two above it.
  std::array<Matches, 3> kept{matches, matches, matches};
  for (std::size_t i = 0; i < rows; ++i) {
    Matches& now = kept[i % 3];
    const Matches& above = kept[(i + 2) % 3];
    const Matches& above2 = kept[(i + 1) % 3];
    for (std::size_t j = 0; j < columns; ++j) {
      float here = wanted.distance(i, motion, j);
      if (damped) {
        const float root = std::sqrt(here);
        here = root * std::sqrt(std::sqrt(root));
      }
      now.costs[j] = i == 0 ? here : kInfinite;
      now.starts[j] = static_cast<std::int32_t>(j);
      const auto take = [&now, j](const Matches& from, std::size_t at, float cost) {
        if (from.costs[at] + cost < now.costs[j]) {
          now.costs[j] = from.costs[at] + cost;
          now.starts[j] = from.starts[at];
        }
      };
      if (i > 0 && j > 0) take(above, j - 1, here);
      if (i > 0 && j > 1) take(above, j - 2, here);
      // Two frames of what is wanted for one of the motion: both are to cost something.
      if (i > 1 && j > 0) take(above2, j - 1, 2 * here);
    }
  }
  matches = kept[(rows - 1) % 3];
  for (float& cost : matches.costs) cost /= static_cast<float>(rows);
  return matches;
}

}  // namespace mocapress
