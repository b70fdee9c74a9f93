// The Alpha Parallelogram Predictor and its floating-point compression (Wang et al., "The alpha
// parallelogram predictor", Information Sciences 232, 2013). Equation and algorithm numbers are the
// paper's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/bit.hpp"
#include "numbers/line.hpp"

namespace mocapress::app {

// What is stored of a value: a float32 where that gives the value back, alone or snapped to the
// column's line.
enum class Precision : std::uint8_t { float64, float32, snapped32 };

struct Column {
  std::int32_t parent;  // the column that predicts this one; -1 for none
  Precision precision;
  Line line;  // on which its numbers lie, which says nothing where it is float64
  int digits;
};

struct Parameters {
  std::span<const double> alphas;  // the lookup table, of 2^k entries
  std::size_t cluster;             // t, frames per cluster
  int mantissa_limit;              // shortest mantissa difference that goes raw; 12 in the paper
};

// For each column, the most compact precision that gives all its values back, bit for bit.
std::vector<Precision> precisions(const double* values, std::size_t frames,
                                  std::span<const Column> columns);

// All below throw std::invalid_argument when the parents of the columns are no tree.

// Codes `frames` x columns.size() values, row by row in `values`, as one chunk that needs no other.
Bytes encode(const double* values, std::size_t frames, std::span<const Column> columns,
             const Parameters& parameters);

// The inverse. Throws std::invalid_argument when `payload` is not what `encode` makes.
void decode(ByteView payload, double* values, std::size_t frames, std::span<const Column> columns,
            const Parameters& parameters);

// IdxSize: bytes of the alpha indices at the front of a chunk (Eqs. 2 and 10).
std::size_t index_size(std::size_t frames, std::size_t columns, const Parameters& parameters);

// The alpha of least squared error (Eq. 9) of each cluster and column, clusters x columns.size();
// 0 where the parent does not move.
std::vector<double> ideal_alphas(const double* values, std::size_t frames,
                                 std::span<const Column> columns, std::size_t cluster);

// Sum of |m - P| over a chunk (the numerator of Eq. 13).
double prediction_error(const double* values, std::size_t frames, std::span<const Column> columns,
                        const Parameters& parameters);

}  // namespace mocapress::app
