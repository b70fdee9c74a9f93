#include "exact/tuning.hpp"

#include <algorithm>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kMoveStep = 2e-4, kScaleStep = 5e-5;
constexpr double kFreedom = 4;
constexpr double kFarthest = 30;  // an error beyond so many widths counts as one of them

MOCAPRESS_VECTOR_CLONES
void add_up(const Block* features, const Block* moves, const Block* scales, std::size_t blocks,
            Block* sums) {
  Block move{}, scale{};
  for (std::size_t b = 0; b < blocks; ++b) {
    move += moves[b] * features[b];
    scale += scales[b] * features[b];
  }
  sums[0] = move;
  sums[1] = scale;
}

MOCAPRESS_VECTOR_CLONES
void follow(double move, double scale, const Block* features, Block* moves, Block* scales,
            std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b) {
    moves[b] += move * features[b];
    scales[b] += scale * features[b];
  }
}

double sum(const Block& lanes) {
  double total = 0;
  for (std::size_t i = 0; i < kLanes; ++i) total += lanes[i];
  return total;
}

}  // namespace

Tuning::Sums Tuning::tell(std::span<const double> features) {
  std::ranges::copy(features, reinterpret_cast<double*>(features_.data()));
  Block sums[2];
  add_up(features_.data(), moves_.data(), scales_.data(), kBlocks, sums);
  return {sum(sums[0]), sum(sums[1])};
}

void Tuning::learn(double error) {
  const double cut = error > kFarthest ? kFarthest : error > -kFarthest ? error : -kFarthest;
  const double slope = (kFreedom + 1) * cut / (kFreedom + cut * cut);
  follow(kMoveStep * slope, kScaleStep * (slope * cut - 1), features_.data(), moves_.data(),
         scales_.data(), kBlocks);
}

}  // namespace mocapress::exact
