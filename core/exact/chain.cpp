#include "exact/chain.hpp"

#include <algorithm>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kTiny = 1e-13;        // keeps the gain of a variable that never moves finite
constexpr std::size_t kTogether = 4;   // chains that learn side by side

// One chain's part of a step.
struct Rows {
  Block* column;  // of the triangle
  double* diagonal;
  Block* rest;
  double alpha;
};

// kCount chains of equal size: while one waits for its division, the others go on.
template <std::size_t kCount>
inline void update_any(Rows* chains, std::size_t size, double fading) {
  const std::size_t blocks = blocks_of(size);
  for (std::size_t j = 0; j < size; ++j) {
    const std::size_t first = j / kLanes;
    for (std::size_t k = 0; k < kCount; ++k) {
      Rows& chain = chains[k];
      const double p = chain.rest[first][j % kLanes];
      const double faded = fading * chain.diagonal[j];
      const double grown = faded + chain.alpha * (p * p);
      const double gain = chain.alpha * p / (grown + kTiny);
      chain.alpha = chain.alpha * (faded + kTiny) / (grown + kTiny);
      chain.diagonal[j] = grown;
      chain.rest[first][j % kLanes] = 0;  // so that nothing is added up to row j
      for (std::size_t b = first; b < blocks; ++b) {
        const Block left = chain.rest[b] - p * *chain.column;
        chain.rest[b] = left;
        *chain.column++ += gain * left;
      }
    }
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

MOCAPRESS_VECTOR_CLONES
void update_one(Rows* chains, std::size_t size, double fading) {
  update_any<1>(chains, size, fading);
}

MOCAPRESS_VECTOR_CLONES
void update_four(Rows* chains, std::size_t size, double fading) {
  update_any<kTogether>(chains, size, fading);
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

void Chain::begin() {
  std::fill_n(predictions_.blocks(), blocks_of(size_), Block{});
}

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
  const auto alike = [&](std::size_t i, std::size_t j) {
    return chains[i]->size_ == chains[j]->size_ && chains[i]->fading_ == chains[j]->fading_;
  };
  for (std::size_t i = 0; i < chains.size();) {
    std::size_t count = 1;
    while (count < kTogether && i + count < chains.size() && alike(i, i + count)) ++count;
    if (count < kTogether) count = 1;
    Rows rows[kTogether];
    for (std::size_t k = 0; k < count; ++k) {
      Chain& chain = *chains[i + k];
      std::copy_n(chain.values_.blocks(), blocks_of(chain.size_), chain.rest_.blocks());
      rows[k] = {chain.triangle_.data(), chain.diagonal_.data(), chain.rest_.blocks(),
                 weights[i + k]};
    }
    (count == 1 ? update_one : update_four)(rows, chains[i]->size_, chains[i]->fading_);
    i += count;
  }
}

}  // namespace mocapress::exact
