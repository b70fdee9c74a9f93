#include "exact_fast/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr float kTiny = 1e-13f;  // keeps the gain of a bend that never is finite
constexpr float kRidge = 1e-4f;
constexpr std::size_t kMostInputs = 12;

// The inputs and then the bend that they explain: each a number for every channel.
using Sources = std::array<const float*, kMostInputs + 1>;

MOCAPRESS_IN_PLACE Fits load(const float* from) {
  Fits fits;
  std::memcpy(&fits, from, sizeof fits);
  return fits;
}

// The learning of exact/chain.cpp for a block of channels, and the weights of the inputs that
// follow from it: an input's is its part in what is explained, less what it tells of later inputs.
MOCAPRESS_IN_PLACE void learn_block(const Sources& sources, std::size_t at, std::size_t inputs,
                                    float fading, Fits* factor, Fits* weights) {
  std::array<Fits, kMostInputs + 1> left;
  for (std::size_t i = 0; i <= inputs; ++i) left[i] = load(sources[i] + at);
  Fits* scale = factor;
  Fits* entry = factor + inputs;
  Fits alpha = 1 + Fits{};
  for (std::size_t j = 0; j < inputs; ++j) {
    const Fits value = left[j];
    const Fits faded = fading * scale[j] + kTiny;
    const Fits grown = faded + alpha * (value * value);
    const Fits ratio = alpha / grown;
    const Fits gain = ratio * value;
    alpha = ratio * faded;
    scale[j] = grown;
    for (std::size_t i = j + 1; i <= inputs; ++i, ++entry) {
      left[i] -= value * *entry;
      *entry += gain * left[i];
    }
  }
  for (std::size_t j = inputs; j-- > 0;) {
    Fits weight = *--entry;
    for (std::size_t i = inputs; i-- > j + 1;) weight -= weights[i] * *--entry;
    weights[j] = weight;
  }
}

// Numbers of inputs that are known when this is compiled keep everything in registers.
MOCAPRESS_VECTOR_CLONES
void learn_blocks(const Sources& sources, std::size_t count, std::size_t inputs, float fading,
                  Fits* factor, Fits* weights) {
  const std::size_t entries = inputs + inputs * (inputs + 1) / 2;
  for (std::size_t b = 0; b < count; ++b, factor += entries, weights += inputs) {
    switch (inputs) {
      case 6:
        learn_block(sources, b * kFits, 6, fading, factor, weights);
        break;
      case 8:
        learn_block(sources, b * kFits, 8, fading, factor, weights);
        break;
      case 10:
        learn_block(sources, b * kFits, 10, fading, factor, weights);
        break;
      default:
        learn_block(sources, b * kFits, kMostInputs, fading, factor, weights);
    }
  }
}

// Adds up what `count` inputs tell, from the first to the last.
MOCAPRESS_VECTOR_CLONES
void add_told(const Sources& sources, std::size_t count, const Fits* weights, std::size_t stride,
              float* told, std::size_t blocks) {
  for (std::size_t b = 0; b < blocks; ++b, weights += stride) {
    Fits sum = load(told + b * kFits);
    for (std::size_t i = 0; i < count; ++i) sum += weights[i] * load(sources[i] + b * kFits);
    std::memcpy(told + b * kFits, &sum, sizeof sum);
  }
}

}  // namespace

template <int kOwn, int kRoots, int kOthers>
Neighbours<kOwn, kRoots, kOthers>::Neighbours(std::size_t channels, float fading)
    : fading_(fading),
      blocks_((channels + kFits - 1) / kFits),
      row_(blocks_ * kFits + kOthers),
      bends_((kOwn + 1) * row_),
      roots_(kRoots * blocks_ * kFits),
      factor_(blocks_ * (kInputs + kEntries)),
      weights_(blocks_ * kInputs),
      told_(blocks_ * kFits) {
  static_assert(kInputs == 6 || kInputs == 8 || kInputs == 10 || kInputs == kMostInputs);
  for (std::size_t b = 0; b < blocks_; ++b) {
    for (std::size_t i = 0; i < kInputs; ++i) factor_[b * (kInputs + kEntries) + i] += kRidge;
  }
}

template <int kOwn, int kRoots, int kOthers>
void Neighbours<kOwn, kRoots, kOthers>::see_roots() {
  Sources sources{};
  for (std::size_t i = 0; i < kRoots; ++i) {
    float* row = roots_.data() + i * blocks_ * kFits;
    std::fill(row + kRoots + kOthers, row + blocks_ * kFits, bends(0)[i]);
    sources[i] = row;
  }
  add_told(sources, kRoots, weights_.data() + kOwn, kInputs, told_.data(), blocks_);
}

template <int kOwn, int kRoots, int kOthers>
void Neighbours<kOwn, kRoots, kOthers>::learn() {
  Sources sources{};
  std::size_t next = 0;
  for (std::size_t age = kOwn; age > 0; --age) sources[next++] = bends(age);
  for (std::size_t i = 0; i < kRoots; ++i) sources[next++] = roots_.data() + i * blocks_ * kFits;
  for (std::size_t i = kOthers; i > 0; --i) sources[next++] = bends(0) - i;
  sources[next] = bends(0);
  learn_blocks(sources, blocks_, kInputs, fading_, factor_.data(), weights_.data());
  for (std::size_t age = kOwn; age > 0; --age) {
    std::copy_n(bends(age - 1), blocks_ * kFits, bends(age));
  }
  std::ranges::fill(told_, 0.0f);
  if (kOwn > 0) add_told(sources, kOwn, weights_.data(), kInputs, told_.data(), blocks_);
}

template class Neighbours<2, 0, 4>;
template class Neighbours<2, 0, 8>;
template class Neighbours<0, 0, 8>;
template class Neighbours<0, 6, 6>;

}  // namespace mocapress::exact
