// What predictors over Algorithm 1 have in common: columns as they are stored, and its contexts.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "app/codec.hpp"
#include "app/correction.hpp"

namespace mocapress::app {

// The contexts of a chunk; those of doubles are large and mostly not needed.
class Corrections {
 public:
  explicit Corrections(int mantissa_limit) : limit_(mantissa_limit) {}

  template <class Float>
  Correction<Float>& of() {
    auto& held = std::get<std::optional<Correction<Float>>>(held_);
    if (!held) held.emplace(limit_);
    return *held;
  }

  bool sound() const {
    return std::apply([](const auto&... held) { return ((!held || held->sound()) && ...); }, held_);
  }

 private:
  int limit_;
  std::tuple<std::optional<Correction<float>>, std::optional<Correction<double>>> held_;
};

// Calls `work` with a float or a double 0, as the column is stored.
template <class Work>
void with_type(Precision precision, Work work) {
  precision == Precision::float64 ? work(double{0}) : work(float{0});
}

// A prediction in the precision of its column; a NaN has no defined bits and is replaced by 0.
template <class Float>
Float rounded(double prediction) {
  return std::isnan(prediction) ? Float{0} : static_cast<Float>(prediction);
}

// Writes a column to every `stride`-th of `values`, moved to its line.
inline void restore_column(const double* column, double* values, std::size_t frames,
                           std::size_t stride, const Column& of) {
  const bool snapped = of.precision == Precision::snapped32;
  const NumberLine line(snapped ? of.line : Line::float64, of.digits);
  for (std::size_t j = 0; j < frames; ++j) values[j * stride] = line.nearest(column[j]);
}

}  // namespace mocapress::app
