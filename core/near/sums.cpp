#include "near/sums.hpp"

#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>
#include <vector>

#include "numbers/arithmetic.hpp"
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

// A tile of kRows x kColumns vectors of sums: in each, row by row, of the products of the row's
// factors with its columns.
template <class Vector, int kRows, int kColumns>
MOCAPRESS_IN_PLACE void add_up(const double* factors, std::size_t next_factors,
                               const double* columns, std::size_t next_columns, std::size_t rows,
                               double* sums, std::size_t next_sums) {
  Vector held[kRows][kColumns] = {};
  for (std::size_t k = 0; k < rows; ++k) {
    Vector column[kColumns];
    for (int c = 0; c < kColumns; ++c) column[c] = load<Vector>(columns + c * kWidth<Vector>);
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c) held[r][c] += factors[r] * column[c];
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

constexpr std::size_t kHalf = kGroup / 2;

// sqrt(2 / 64) cos(pi k (t + 1/2) / 64) for t < 32 at [32 t + (k - 1) / 2], of odd k, and behind
// these of even ones at [32 t + k / 2 - 1]; 0 behind the last.
const double* cosines() {
  static const auto kCosines = [] {
    std::vector<double> turns(4 * kGroup), table(2 * kHalf * kHalf);
    const double height = std::sqrt(2.0 / 64);
    for (std::size_t i = 0; i < turns.size(); ++i) {
      turns[i] = height * sine_cosine(3.141592653589793 * static_cast<double>(i) / 128).cosine;
    }
    for (std::size_t k = 1; k < kGroup; ++k) {
      for (std::size_t t = 0; t < kHalf; ++t) {
        const std::size_t place = kHalf * t + (k - 1) / 2;
        table[k % 2 == 1 ? place : kHalf * kHalf + place] = turns[k * (2 * t + 1) % turns.size()];
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
    const double* const block = numbers + column / kFill * kFill * kGroup + column % kFill;
    double* const to = waves + column / kFill * kFill * kWaves + column % kFill;
    for (const std::size_t odd : {std::size_t{1}, std::size_t{0}}) {
      const double* const own = table + (odd == 1 ? 0 : kHalf * kHalf);
      const double* const halves = block + (odd == 1 ? kHalf * kFill : 0);
      // The last even wave is none: its row lies behind those that are asked for.
      for (std::size_t k = 0; k < kHalf; k += 4) {
        double sums[4 * kStep];
        add_up<Vector, 4, 2>(own + k, kHalf, halves, kFill, kHalf, sums, kStep);
        for (std::size_t r = 0; r < 4; ++r) {
          const std::size_t row = 2 * (k + r) + 1 - odd;
          if (row >= kWaves) break;
          std::memcpy(to + row * kFill, sums + r * kStep, kStep * sizeof(double));
        }
      }
    }
  }
}

constexpr std::size_t kTileRows = 2, kTileColumns = kFill / 2;  // channels

std::pair<std::size_t, std::size_t> tile_of(const Use& use) {
  return {use.row / kTileRows, use.column / kTileColumns};
}

template <class Vector>
MOCAPRESS_IN_PLACE void products_with(const double* waves, const Use* use, const Use* end,
                                      const double* weights, double* sums) {
  constexpr std::size_t kStep = 2 * kWidth<Vector>, kVectors = 4 / kWidth<Vector>;
  while (use != end) {
    const auto tile = tile_of(*use);
    const std::size_t top = 2 * kTileRows * tile.first;
    const double* rows = waves + top / kFill * kFill * kWaves + top % kFill;
    const double* columns = waves + kFill * kWaves * tile.second;
    double products[kWaveBands][2 * kTileRows][kFill];
    std::size_t first = 0;
    for (std::size_t band = 0; band < kWaveBands; ++band) {
      const std::size_t size = kBandEnds[band] - first;
      for (std::size_t column = 0; column < kFill; column += kStep) {
        add_up<Vector, 2 * kTileRows, 2>(rows, kFill, columns + column, kFill, size,
                                         &products[band][0][column], kFill);
      }
      rows += size * kFill;
      columns += size * kFill;
      first = kBandEnds[band];
    }
    while (use != end && tile_of(*use) == tile) {
      const std::uint32_t row = use->row, column = use->column;
      Vector held[kWaveBands][kVectors];
      for (std::size_t band = 0; band < kWaveBands; ++band) {
        double four[4];
        const std::size_t r = 2 * (row % kTileRows), c = 2 * (column % kTileColumns);
        std::memcpy(four, &products[band][r][c], 2 * sizeof(double));
        std::memcpy(four + 2, &products[band][r + 1][c], 2 * sizeof(double));
        std::memcpy(held[band], four, sizeof four);
      }
      for (; use != end && use->row == row && use->column == column; ++use) {
        const double* const own = weights + std::size_t{use->channel} * kWaveBands;
        double* const place = sums + std::size_t{4} * use->place;
        for (std::size_t v = 0; v < kVectors; ++v) {
          Vector sum = load<Vector>(place + v * kWidth<Vector>);
          for (std::size_t band = 0; band < kWaveBands; ++band) sum += own[band] * held[band][v];
          std::memcpy(place + v * kWidth<Vector>, &sum, sizeof sum);
        }
      }
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
      for (std::size_t v = 0; v < kVectors; ++v) {
        held[v] += shares[a] * load<Vector>(features[a] + t + v * kWidth<Vector>);
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

// Takes from kCount vectors of a row the products of rows above with their factors for it.
template <class Vector, std::size_t kCount>
MOCAPRESS_IN_PLACE void take_above(double* row, const double* above, const double* factors,
                                   std::size_t next, std::size_t rows) {
  Vector held[kCount];
  for (std::size_t v = 0; v < kCount; ++v) held[v] = load<Vector>(row + v * kWidth<Vector>);
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t v = 0; v < kCount; ++v) {
      held[v] -= factors[k * next] * load<Vector>(above + k * next + v * kWidth<Vector>);
    }
  }
  std::memcpy(row, held, sizeof held);
}

// Cholesky's decomposition of a matrix, of which only what stands above the diagonal is right, and
// of the column behind it.
template <class Vector>
MOCAPRESS_IN_PLACE bool reduce_with(double* matrix, std::size_t m) {
  const std::size_t next = filled(m + 1);
  for (std::size_t i = 0; i < m; ++i) {
    double* const row = matrix + i * next;
    const std::size_t begin = i / kFill * kFill;
    for (std::size_t column = begin; column < next;) {
      double *const own = row + column, *const above = matrix + column;
      if (next - column >= 3 * kFill) {
        take_above<Vector, 3 * kFill / kWidth<Vector>>(own, above, matrix + i, next, i);
        column += 3 * kFill;
      } else {
        take_above<Vector, kFill / kWidth<Vector>>(own, above, matrix + i, next, i);
        column += kFill;
      }
    }
    if (!(row[i] > 0)) return false;
    const double root = std::sqrt(row[i]);
    for (std::size_t column = begin; column < next; column += kWidth<Vector>) {
      const Vector quotients = load<Vector>(row + column) / root;
      std::memcpy(row + column, &quotients, sizeof quotients);
    }
    row[i] = root;
  }
  return true;
}

MOCAPRESS_WIDE bool wide_reduce(double* matrix, std::size_t m) {
  return reduce_with<Four>(matrix, m);
}

MOCAPRESS_WIDE void wide_waves(const double* table, const double* numbers, std::size_t count,
                               double* waves) {
  waves_with<Four>(table, numbers, count, waves);
}

MOCAPRESS_WIDE void wide_products(const double* waves, const Use* use, const Use* end,
                                  const double* weights, double* sums) {
  products_with<Four>(waves, use, end, weights, sums);
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

void sort_uses(std::vector<Use>& uses, std::size_t channels) {
  // By columns, and in these by which channel of a tile a row is; then by rows of tiles.
  std::vector<Use> others(uses.size());
  const auto sort = [&](std::size_t keys, auto&& key_of) {
    std::vector<std::size_t> next(keys + 1);
    for (const Use& use : uses) ++next[key_of(use) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const Use& use : uses) others[next[key_of(use)]++] = use;
    uses.swap(others);
  };
  sort(kTileRows * channels,
       [](const Use& use) { return kTileRows * use.column + use.row % kTileRows; });
  sort(channels, [](const Use& use) { return use.row / kTileRows; });
}

void add_products(const double* waves, const std::vector<Use>& uses, const double* weights,
                  double* sums) {
  const Use *const first = uses.data(), *const end = first + uses.size();
  if (is_wide()) return wide_products(waves, first, end, weights, sums);
  products_with<Two>(waves, first, end, weights, sums);
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

bool solve(double* matrix, double* x, std::size_t m) {
  const bool solved = is_wide() ? wide_reduce(matrix, m) : reduce_with<Two>(matrix, m);
  const std::size_t next = filled(m + 1);
  for (std::size_t i = m; solved && i-- > 0;) {
    const double* const row = matrix + i * next;
    double rest = row[m];
    for (std::size_t k = i + 1; k < m; ++k) rest -= row[k] * x[k];
    x[i] = rest / row[i];
  }
  return solved;
}

}  // namespace mocapress::near
