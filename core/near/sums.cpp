#include "near/sums.hpp"

#include <cmath>
#include <cstring>
#include <vector>

#include "numbers/arithmetic.hpp"
#include "numbers/vector_clones.hpp"
#include "numbers/wide.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

using Two = double __attribute__((vector_size(2 * sizeof(double))));
using Four = double __attribute__((vector_size(4 * sizeof(double))));

template <class Vector>
inline constexpr std::size_t kWidth = sizeof(Vector) / sizeof(double);

template <class Vector>
MOCAPRESS_IN_PLACE Vector load(const double* from) {
  Vector numbers;
  std::memcpy(&numbers, from, sizeof(Vector));
  return numbers;
}

// A tile of kRows x kColumns vectors of sums: each has added, row by row, the products of the row's
// factors with its columns.
template <class Vector, int kRows, int kColumns>
MOCAPRESS_IN_PLACE void add_tile(const double* factors, std::size_t next_factor,
                                 std::size_t next_factors, const double* columns,
                                 std::size_t next_columns, std::size_t rows, double* sums,
                                 std::size_t next_sums) {
  Vector held[kRows][kColumns];
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c)
      held[r][c] = load<Vector>(sums + r * next_sums + c * kWidth<Vector>);
  }
  for (std::size_t k = 0; k < rows; ++k) {
    Vector column[kColumns];
    for (int c = 0; c < kColumns; ++c) column[c] = load<Vector>(columns + c * kWidth<Vector>);
    for (int r = 0; r < kRows; ++r) {
      const Vector factor = Vector{} + factors[r * next_factor];
      for (int c = 0; c < kColumns; ++c) held[r][c] += factor * column[c];
    }
    factors += next_factors;
    columns += next_columns;
  }
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      std::memcpy(sums + r * next_sums + c * kWidth<Vector>, &held[r][c], sizeof(Vector));
    }
  }
}

// sqrt(2 / 64) cos(pi k (t + 1/2) / 64) at [64 t + k - 1]; 0 behind the last.
const double* cosines() {
  static const auto kCosines = [] {
    std::vector<double> turns(4 * kGroup), table(kGroup * kGroup);
    const double height = std::sqrt(2.0 / 64);
    for (std::size_t i = 0; i < turns.size(); ++i) {
      turns[i] = height * sine_cosine(3.141592653589793 * static_cast<double>(i) / 128).cosine;
    }
    for (std::size_t k = 1; k < kGroup; ++k) {
      for (std::size_t t = 0; t < kGroup; ++t) {
        table[kGroup * t + k - 1] = turns[k * (2 * t + 1) % turns.size()];
      }
    }
    return table;
  }();
  return kCosines.data();
}

template <class Vector>
MOCAPRESS_IN_PLACE void waves_with(const double* table, const double* numbers, std::size_t count,
                                   double* waves) {
  constexpr std::size_t kStep = 2 * kWidth<Vector>;
  for (std::size_t column = 0; column < count; column += kStep) {
    // The last wave is none: its row lies behind those that are asked for.
    for (std::size_t k = 0; k < kGroup; k += 4) {
      double sums[4 * kStep] = {};
      add_tile<Vector, 4, 2>(table + k, 1, kGroup, numbers + column, count, kGroup, sums, kStep);
      for (std::size_t r = 0; r < 4 && k + r < kWaves; ++r) {
        std::memcpy(waves + (k + r) * count + column, sums + r * kStep, kStep * sizeof(double));
      }
    }
  }
}

template <class Vector>
MOCAPRESS_IN_PLACE void products_with(const double* features, const double* weighed,
                                      const double* aims, std::size_t count, double* matrix,
                                      double* sums) {
  constexpr std::size_t kStep = 2 * kWidth<Vector>;
  for (std::size_t column = 0; column < count; column += kStep) {
    add_tile<Vector, 1, 2>(aims, 0, 1, weighed + column, count, kWaves, sums + column, 0);
  }
  for (std::size_t row = 0; row < count; row += 4) {
    for (std::size_t column = row / kStep * kStep; column < count; column += kStep) {
      add_tile<Vector, 4, 2>(features + row, 1, count, weighed + column, count, kWaves,
                             matrix + row * count + column, count);
    }
  }
}

template <class Vector>
MOCAPRESS_IN_PLACE void weigh_with(const double* const* features, const double* shares,
                                   std::size_t count, std::size_t length, double* sums) {
  constexpr std::size_t kStep = 8;
  constexpr std::size_t kVectors = kStep / kWidth<Vector>;
  for (std::size_t t = 0; t < length; t += kStep) {
    Vector held[kVectors] = {};
    for (std::size_t a = 0; a < count; ++a) {
      const Vector share = Vector{} + shares[a];
      for (std::size_t v = 0; v < kVectors; ++v) {
        held[v] += share * load<Vector>(features[a] + t + v * kWidth<Vector>);
      }
    }
    std::memcpy(sums + t, held, sizeof held);
  }
}

template <class Vector>
MOCAPRESS_IN_PLACE void average_with(const double* numbers, std::size_t length, double* sums) {
  constexpr std::size_t kStep = 8;
  constexpr std::size_t kVectors = kStep / kWidth<Vector>;
  for (std::size_t t = 0; t < length; t += kStep) {
    Vector held[kVectors] = {};
    for (std::size_t k = 0; k <= 2 * kReach; ++k) {
      const auto weight = static_cast<double>(k <= kReach ? k + 1 : 2 * kReach + 1 - k);
      for (std::size_t v = 0; v < kVectors; ++v) {
        held[v] += weight * load<Vector>(numbers + t + k + v * kWidth<Vector>);
      }
    }
    std::memcpy(sums + t, held, sizeof held);
  }
}

MOCAPRESS_WIDE void wide_waves(const double* table, const double* numbers, std::size_t count,
                               double* waves) {
  waves_with<Four>(table, numbers, count, waves);
}

MOCAPRESS_WIDE void wide_products(const double* features, const double* weighed, const double* aims,
                                  std::size_t count, double* matrix, double* sums) {
  products_with<Four>(features, weighed, aims, count, matrix, sums);
}

MOCAPRESS_WIDE void wide_weigh(const double* const* features, const double* shares,
                               std::size_t count, std::size_t length, double* sums) {
  weigh_with<Four>(features, shares, count, length, sums);
}

MOCAPRESS_WIDE void wide_average(const double* numbers, std::size_t length, double* sums) {
  average_with<Four>(numbers, length, sums);
}

}  // namespace

void waves_of(const double* numbers, std::size_t count, double* waves) {
  if (is_wide()) return wide_waves(cosines(), numbers, count, waves);
  waves_with<Two>(cosines(), numbers, count, waves);
}

void add_products(const double* features, const double* weighed, const double* aims,
                  std::size_t count, double* matrix, double* sums) {
  if (is_wide()) return wide_products(features, weighed, aims, count, matrix, sums);
  products_with<Two>(features, weighed, aims, count, matrix, sums);
}

void weigh(const double* const* features, const double* shares, std::size_t count,
           std::size_t length, double* sums) {
  if (is_wide()) return wide_weigh(features, shares, count, length, sums);
  weigh_with<Two>(features, shares, count, length, sums);
}

void average(const double* numbers, std::size_t length, double* sums) {
  if (is_wide()) return wide_average(numbers, length, sums);
  average_with<Two>(numbers, length, sums);
}

MOCAPRESS_VECTOR_CLONES
bool solve(double* matrix, double* x, std::size_t m) {
  const std::size_t next = filled(m);
  for (std::size_t k = 0; k < m; ++k) {
    double* const own = matrix + k * next;
    if (!(own[k] > 0)) return false;
    own[k] = std::sqrt(own[k]);
    for (std::size_t j = k + 1; j < m; ++j) own[j] = own[j] / own[k];
    x[k] = x[k] / own[k];
    for (std::size_t i = k + 1; i < m; ++i) {
      double* const row = matrix + i * next;
      const double factor = own[i];
      for (std::size_t j = i; j < m; ++j) row[j] -= factor * own[j];
      x[i] -= factor * x[k];
    }
  }
  for (std::size_t i = m; i-- > 0;) {
    const double* const row = matrix + i * next;
    for (std::size_t k = i + 1; k < m; ++k) x[i] -= row[k] * x[k];
    x[i] = x[i] / row[i];
  }
  return true;
}

}  // namespace mocapress::near
