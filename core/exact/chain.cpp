#include "exact/chain.hpp"

#include <algorithm>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr std::size_t kTogether = 4;  // chains that learn side by side

// One chain's part of a step.
struct Rows {
  std::size_t size;
  double fading;
  Block* column;  // of the triangle
  double* diagonal;
  Block* rest;
  double alpha;
};

// Step j of a chain.
MOCAPRESS_IN_PLACE void step(Rows& chain, std::size_t j) {
  const std::size_t first = j / kLanes;
  const std::size_t blocks = blocks_of(chain.size);
  const double p = chain.rest[first][j % kLanes];
  const double faded = chain.fading * chain.diagonal[j];
  const double grown = faded + chain.alpha * (p * p);
  const double gain = chain.alpha * p / (grown + kLeastGrown);
  chain.alpha = chain.alpha * (faded + kLeastGrown) / (grown + kLeastGrown);
  chain.diagonal[j] = grown;
  chain.rest[first][j % kLanes] = 0;  // so that nothing is added up to row j
  for (std::size_t b = first; b < blocks; ++b) {
    const Block left = chain.rest[b] - p * *chain.column;
    chain.rest[b] = left;
    *chain.column++ += gain * left;
  }
}

MOCAPRESS_VECTOR_CLONES
void see_run(Block* predictions, const Block* columns, std::size_t first, const double* values,
             double* seen, std::size_t count, std::size_t blocks) {
  for (std::size_t j = first; j < first + count; ++j, ++values) {
    seen[j] = *values;
    const std::size_t begin = j / kLanes;
    const double innovation = *values - predictions[begin][j % kLanes];
    for (std::size_t b = begin; b < blocks; ++b) predictions[b] += innovation * *columns++;
  }
}

// While one chain waits for its division, the others go on. Longer chains come first.
MOCAPRESS_VECTOR_CLONES
void update(Rows* chains, std::size_t count) {
  for (std::size_t j = 0; j < chains[0].size; ++j) {
    for (std::size_t k = 0; k < count && j < chains[k].size; ++k) step(chains[k], j);
  }
}

}  // namespace

Chain::Chain(std::size_t count, double fading, double ridge)
    : size_(count),
      fading_(fading),
      diagonal_(count, ridge),
      offsets_(count),
      predictions_(count, 0),
      values_(count, 0),
      rest_(count, 0) {
  std::size_t size = 0;
  for (std::size_t j = 0; j < count; ++j) {
    offsets_[j] = size;
    size += blocks_of(count) - j / kLanes;
  }
  triangle_.resize(size);
}

void Chain::begin() { std::fill_n(predictions_.data(), blocks_of(size_) * kLanes, 0.0); }

void Chain::see(std::size_t first, std::span<const double> values) {
  if (values.empty()) return;
  see_run(predictions_.blocks(), column_blocks(first), first, values.data(), values_.data(),
          values.size(), blocks_of(size_));
}

void Chain::learn(double weight) {
  Chain* const self = this;
  learn_all(std::span(&self, 1), std::span(&weight, 1));
}

void Chain::learn_all(std::span<Chain* const> chains, std::span<const double> weights) {
  for (std::size_t i = 0; i < chains.size();) {
    Rows rows[kTogether];
    const std::size_t count = std::min(kTogether, chains.size() - i);
    for (std::size_t k = 0; k < count; ++k, ++i) {
      Chain& chain = *chains[i];
      std::copy_n(chain.values_.blocks(), blocks_of(chain.size_), chain.rest_.blocks());
      rows[k] = {
          chain.size_,          chain.fading_, chain.triangle_.data(), chain.diagonal_.data(),
          chain.rest_.blocks(), weights[i]};
    }
    update(rows, count);
  }
}

}  // namespace mocapress::exact
