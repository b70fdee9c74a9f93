#include "exact/parallel_chains.hpp"

#include <array>

#include "coding/fail.hpp"
#include "exact/chain.hpp"
#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr std::size_t kMost = ParallelChains::kMost;

inline double predicted_in_lane(const Block* block, std::size_t size, std::size_t lane) {
  const Block* triangle = block + size;
  std::array<double, kMost> predictions{};
  for (std::size_t j = 0; j + 1 < size; ++j) {
    const double innovation = block[j][lane] - predictions[j];
    for (std::size_t r = j + 1; r < size; ++r) {
      predictions[r] += (*triangle++)[lane] * innovation;
    }
  }
  return predictions[size - 1];
}

// Eight chains at once.
MOCAPRESS_IN_PLACE void update_block(Block* block, std::size_t size, double fading, Block alpha) {
  Block* triangle = block + size;
  Block* diagonal = triangle + size * (size - 1) / 2;
  std::array<Block, kMost> rest;
  for (std::size_t j = 0; j < size; ++j) rest[j] = block[j];
  for (std::size_t j = 0; j < size; ++j) {
    const Block p = rest[j];
    const Block faded = fading * diagonal[j];
    const Block grown = faded + alpha * (p * p);
    const Block gain = alpha * p / (grown + kLeastGrown);
    alpha = alpha * (faded + kLeastGrown) / (grown + kLeastGrown);
    diagonal[j] = grown;
    for (std::size_t r = j + 1; r < size; ++r, ++triangle) {
      rest[r] -= p * *triangle;
      *triangle += gain * rest[r];
    }
  }
}

MOCAPRESS_VECTOR_CLONES
void predict_blocks(const Block* blocks, std::size_t count, std::size_t size, std::size_t stride,
                    Block* predictions) {
  for (std::size_t b = 0; b < count; ++b, blocks += stride) {
    const Block* triangle = blocks + size;
    std::array<Block, kMost> sums{};
    for (std::size_t j = 0; j + 1 < size; ++j) {
      const Block innovation = blocks[j] - sums[j];
      for (std::size_t r = j + 1; r < size; ++r) sums[r] += *triangle++ * innovation;
    }
    predictions[b] = sums[size - 1];
  }
}

// Sizes that are known when this is compiled keep everything in registers.
MOCAPRESS_VECTOR_CLONES
void update_blocks(Block* blocks, std::size_t count, std::size_t size, std::size_t stride,
                   double fading, const Block* weights) {
  for (std::size_t b = 0; b < count; ++b, blocks += stride, ++weights) {
    switch (size) {
      case 2:
        update_block(blocks, 2, fading, *weights);
        break;
      case 3:
        update_block(blocks, 3, fading, *weights);
        break;
      case 4:
        update_block(blocks, 4, fading, *weights);
        break;
      case 5:
        update_block(blocks, 5, fading, *weights);
        break;
      case 18:
        update_block(blocks, 18, fading, *weights);
        break;
      default:
        update_block(blocks, size, fading, *weights);
    }
  }
}

}  // namespace

ParallelChains::ParallelChains(std::size_t chains, std::size_t size, double fading, double ridge)
    : size_(size),
      fading_(fading),
      stride_(2 * size + size * (size - 1) / 2),
      blocks_(blocks_of(chains) * stride_) {
  if (size > kMost) fail("more predictors of a column than there can be");
  for (std::size_t b = stride_ - size; b < blocks_.size(); b += stride_) {
    for (std::size_t j = 0; j < size; ++j) blocks_[b + j] += ridge;
  }
}

double ParallelChains::predicted(std::size_t chain) const {
  const Block* const block = blocks_.data() + chain / kLanes * stride_;
  const std::size_t lane = chain % kLanes;
  // The usual one, known when this is compiled.
  return size_ == 2 ? predicted_in_lane(block, 2, lane) : predicted_in_lane(block, size_, lane);
}

void ParallelChains::predict_all(Block* predictions) const {
  predict_blocks(blocks_.data(), blocks_.size() / stride_, size_, stride_, predictions);
}

void ParallelChains::learn(const Block* weights) {
  update_blocks(blocks_.data(), blocks_.size() / stride_, size_, stride_, fading_, weights);
}

}  // namespace mocapress::exact
