#include "exact_fast/neighbours.hpp"

#include <algorithm>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kTiny = 1e-13;  // keeps the gain of a bend that never is finite
constexpr double kRidge = 1e-4;
constexpr std::size_t kLanes = 8;

// What follows is done for `count` channels at once, a multiple of kLanes; it is the learning of
// exact/chain.cpp.

// How much is learned from an input that its fit has not told: `values` are that.
MOCAPRESS_VECTOR_CLONES
void weigh(const double* __restrict values, double* __restrict scale, double* __restrict alpha,
           double* __restrict gain, double fading, std::size_t count) {
  for (std::size_t c = 0; c < count; ++c) {
    const double faded = fading * scale[c];
    const double grown = faded + alpha[c] * (values[c] * values[c]);
    const double ratio = alpha[c] / (grown + kTiny);
    gain[c] = ratio * values[c];
    alpha[c] = ratio * (faded + kTiny);
    scale[c] = grown;
  }
}

// Takes from `later` what `values` tell of it, and learns from the rest.
MOCAPRESS_VECTOR_CLONES
void explain(const double* __restrict values, const double* __restrict gain,
             double* __restrict factor, double* __restrict later, std::size_t count) {
  for (std::size_t c = 0; c < count; ++c) {
    const double left = later[c] - values[c] * factor[c];
    later[c] = left;
    factor[c] += gain[c] * left;
  }
}

MOCAPRESS_VECTOR_CLONES
void add_product(const double* __restrict a, const double* __restrict b, double* __restrict sum,
                 double sign, std::size_t count) {
  for (std::size_t c = 0; c < count; ++c) sum[c] += sign * (a[c] * b[c]);
}

}  // namespace

Neighbours::Neighbours(std::size_t channels, const NeighbourPlan& plan)
    : own_(plan.own),
      inputs_(plan.own + plan.others),
      fading_(plan.fading),
      row_((channels + kLanes - 1) / kLanes * kLanes),
      bends_((own_ + 1) * (row_ + kMostOthers)),
      factor_(inputs_ * (inputs_ + 1) / 2 * row_),
      scale_(inputs_ * row_, kRidge),
      weights_(inputs_ * row_),
      told_(row_),
      values_((inputs_ + 1) * row_),
      alpha_(row_),
      gain_(row_) {}

void Neighbours::learn() {
  // The variables: own bends, oldest first, others, the farthest first, and what they explain.
  for (std::size_t i = 0; i <= inputs_; ++i) {
    const double* from = i < own_ ? bends(own_ - i) : bends(0) - (inputs_ - i);
    std::copy_n(from, row_, values_.data() + i * row_);
  }
  std::ranges::fill(alpha_, 1.0);
  double* entry = factor_.data();
  for (std::size_t j = 0; j < inputs_; ++j) {
    const double* values = values_.data() + j * row_;
    weigh(values, scale_.data() + j * row_, alpha_.data(), gain_.data(), fading_, row_);
    for (std::size_t i = j + 1; i <= inputs_; ++i, entry += row_) {
      explain(values, gain_.data(), entry, values_.data() + i * row_, row_);
    }
  }
  // From the last input to the first: its weight is its part in what is explained, less what it
  // tells of later inputs.
  for (std::size_t j = inputs_; j-- > 0;) {
    double* weight = weights_.data() + j * row_;
    entry -= row_;
    std::copy_n(entry, row_, weight);
    for (std::size_t i = inputs_; i-- > j + 1;) {
      entry -= row_;
      add_product(entry, weights_.data() + i * row_, weight, -1, row_);
    }
  }
  std::ranges::fill(told_, 0.0);
  for (std::size_t i = 0; i < own_; ++i) {
    add_product(weights_.data() + i * row_, bends(own_ - 1 - i), told_.data(), 1, row_);
  }
  for (std::size_t age = own_; age > 0; --age) std::copy_n(bends(age - 1), row_, bends(age));
}

}  // namespace mocapress::exact
