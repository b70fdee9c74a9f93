#include "exact/chain.hpp"

#include <algorithm>

#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr double kTiny = 1e-13;    // keeps the gain of a variable that never moves finite
constexpr std::size_t kShort = 8;  // not worth a call that chooses the instruction set

inline void add_scaled_any(double* __restrict to, const double* __restrict from, double factor,
                           std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += factor * from[i];
}

inline void update_any(double* __restrict triangle, double* __restrict diagonal,
                       double* __restrict rest, std::size_t count, double fading, double alpha) {
  for (std::size_t j = 0; j < count; ++j) {
    const double p = rest[j];
    const double faded = fading * diagonal[j];
    const double grown = faded + alpha * (p * p);
    const double gain = alpha * p / (grown + kTiny);
    alpha = alpha * (faded + kTiny) / (grown + kTiny);
    diagonal[j] = grown;
    const std::size_t below = count - j - 1;
    double* __restrict later = rest + j + 1;
    if (p != 0) {
      for (std::size_t i = 0; i < below; ++i) {
        const double left = later[i] - p * triangle[i];
        later[i] = left;
        triangle[i] += gain * left;
      }
    }
    triangle += below;
  }
}

MOCAPRESS_VECTOR_CLONES
void add_scaled(double* to, const double* from, double factor, std::size_t count) {
  add_scaled_any(to, from, factor, count);
}

MOCAPRESS_VECTOR_CLONES
void update(double* triangle, double* diagonal, double* rest, std::size_t count, double fading,
            double alpha) {
  update_any(triangle, diagonal, rest, count, fading, alpha);
}

}  // namespace

Chain::Chain(std::size_t count, double fading, double ridge)
    : fading_(fading),
      diagonal_(count, ridge),
      offsets_(count),
      predictions_(count),
      values_(count),
      rest_(count) {
  std::size_t size = 0;
  for (std::size_t j = 0; j < count; ++j) {
    offsets_[j] = size;
    size += count - j - 1;
  }
  triangle_.assign(size, 0);
}

void Chain::begin() { std::fill(predictions_.begin(), predictions_.end(), 0.0); }

void Chain::see(std::size_t variable, double value) {
  values_[variable] = value;
  const double innovation = value - predictions_[variable];
  if (innovation == 0) return;
  const std::size_t later = size() - variable - 1;
  (later < kShort ? add_scaled_any : add_scaled)(predictions_.data() + variable + 1,
                                                 column(variable), innovation, later);
}

void Chain::learn(double weight) {
  rest_ = values_;
  (size() <= kShort ? update_any : update)(triangle_.data(), diagonal_.data(), rest_.data(), size(),
                                           fading_, weight);
}

}  // namespace mocapress::exact
