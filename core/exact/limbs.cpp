#include "exact/limbs.hpp"

#include <algorithm>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

// A variable that all of eight chains share.
MOCAPRESS_VECTOR_CLONES
void see_shared(double value, const Block* column, Block* predictions, std::size_t later) {
  const Block innovation = value - *predictions++;
  for (std::size_t i = 0; i < later; ++i) predictions[i] += innovation * column[i];
}

// How much the frame counts for each of eight limbs, from its channels' innovations.
MOCAPRESS_VECTOR_CLONES
void weigh(const Block* innovations, Block* usual, const Block* targets, Block* weights) {
  Block sum{};
  for (std::size_t i = 0; i < kLimb; ++i) {
    sum += unusualness(innovations[i] * innovations[i], usual[i]);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    (*weights)[i] = weight_of_frame(sum[i], (*targets)[i]);
  }
}

std::size_t count_limbs(std::size_t channels) { return (channels + kLimb - 1) / kLimb; }

}  // namespace

Limbs::Limbs(const LimbsPlan& plan, std::size_t channels)
    : plan_(plan),
      channels_(channels),
      most_(known_before(count_limbs(channels) - 1) + kLimb),
      chains_(count_limbs(channels), most_, plan.fading, kChainRidge),
      targets_(count_limbs(channels), static_cast<double>(kLimb)),
      weights_(count_limbs(channels), 0) {
  predictions_.resize(weights_.count_blocks() * most_);
  innovations_.resize(weights_.count_blocks() * kLimb);
  usual_.assign(innovations_.size(), kChainRidge + Block{});
  if (channels % kLimb != 0) {
    targets_[channels / kLimb] = static_cast<double>(channels % kLimb);
  }
}

void Limbs::begin() {
  const auto numbers = reinterpret_cast<double*>(predictions_.data());
  std::fill_n(numbers, predictions_.size() * kLanes, 0.0);
  limb_ = first_ = known_ = 0;
}

// A variable of the limb's own chain. Gives its innovation.
double Limbs::see(std::size_t variable, double value) {
  chains_.see(limb_, variable, value);
  const std::size_t block = limb_ / kLanes, lane = limb_ % kLanes;
  auto* told = reinterpret_cast<double*>(predictions_.data() + block * most_ + variable) + lane;
  const auto* entry = reinterpret_cast<const double*>(chains_.column(block, variable)) + lane;
  const double innovation = value - *told;
  for (std::size_t i = variable + 1; i < most_; ++i, entry += kLanes) {
    told += kLanes;
    *told += innovation * *entry;
  }
  return innovation;
}

void Limbs::see_target(std::size_t channel, const Frames& frames) {
  const std::size_t own = channel - first_;
  const std::size_t block = limb_ / kLanes;
  reinterpret_cast<double*>(&innovations_[block * kLimb + own])[limb_ % kLanes] =
      see(known_ + own, value(channel, frames));
}

// Also of the root's own chain, whose predictions are no longer needed.
void Limbs::see_root(const Frames& frames) {
  for (std::size_t block = 0; block < weights_.count_blocks(); ++block) {
    Block* predictions = predictions_.data() + block * most_;
    for (std::size_t i = 0; i < kLimb; ++i) {
      const double shared = value(i, frames);
      chains_.values(block)[i] = shared + Block{};
      see_shared(shared, chains_.column(block, i), predictions + i, most_ - i - 1);
    }
  }
}

void Limbs::enter(std::size_t limb, const Frames& frames) {
  const std::size_t last = first_;
  if (limb == 1) see_root(frames);
  limb_ = limb;
  first_ = limb * kLimb;
  known_ = known_before(limb);
  if (limb == 1) return;
  for (std::size_t i = 0; i < kLimb; ++i) {
    see(known_ - kLimb + i, value(last + i, frames));
  }
}

double Limbs::predict(std::size_t channel, const Frames& frames) {
  if (channel > 0) see_target(channel - 1, frames);
  if (channel == first_ + kLimb) enter(limb_ + 1, frames);
  const std::size_t variable = known_ + channel - first_;
  const Block* told = predictions_.data() + limb_ / kLanes * most_ + variable;
  const double before = frames.level(channel, 1);
  const double extrapolated = plan_.order == 1 ? before : before + frames.difference(channel, 1, 1);
  return extrapolated + reinterpret_cast<const double*>(told)[limb_ % kLanes];
}

void Limbs::learn(const Frames& frames) {
  see_target(channels_ - 1, frames);
  for (std::size_t block = 0; block < weights_.count_blocks(); ++block) {
    const std::size_t first = block * kLimb;
    weigh(innovations_.data() + first, usual_.data() + first, &targets_.block(block),
          &weights_.block(block));
  }
  chains_.learn(weights_.blocks());
}

}  // namespace mocapress::exact
