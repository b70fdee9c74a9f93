// The first singular pair of a matrix.
#pragma once

#include <cmath>
#include <cstddef>

#include "numbers/lanes.hpp"
#include "qssd_learning/turns.hpp"

namespace mocapress::qssd {

// Of rows of so many blocks: `direction`, which is of length 1 and where to begin from, becomes the
// first right singular vector, and `along` each row's component along it. Gives false, and leaves
// `direction` as it is, where all rows are 0.
MOCAPRESS_IN_PLACE bool first_pair(const Block* rows, std::size_t count, std::size_t blocks,
                                   Block* direction, double* along, Block* scratch) {
  constexpr int kMostRounds = 60;
  constexpr double kSettled = 1e-9;
  const auto project = [&](std::size_t r) {
    Block sum{};
    for (std::size_t b = 0; b < blocks; ++b) sum += rows[r * blocks + b] * direction[b];
    return total(sum);
  };
  for (int round = 0; round < kMostRounds; ++round) {
    for (std::size_t b = 0; b < blocks; ++b) scratch[b] = Block{};
    for (std::size_t r = 0; r < count; ++r) {
      const double weight = project(r);
      for (std::size_t b = 0; b < blocks; ++b) scratch[b] += weight * rows[r * blocks + b];
    }
    Block squares{};
    for (std::size_t b = 0; b < blocks; ++b) squares += scratch[b] * scratch[b];
    const double length = std::sqrt(total(squares));
    // The direction may be at right angles to all rows: then the first row is a better beginning.
    if (!(length > 0)) {
      if (round > 0 || count == 0) return false;
      Block own{};
      for (std::size_t b = 0; b < blocks; ++b) own += rows[b] * rows[b];
      const double first = std::sqrt(total(own));
      if (!(first > 0)) return false;
      for (std::size_t b = 0; b < blocks; ++b) direction[b] = rows[b] / first;
      continue;
    }
    Block moved{};
    for (std::size_t b = 0; b < blocks; ++b) {
      const Block next = scratch[b] / length;
      const Block move = next - direction[b];
      moved += move * move;
      direction[b] = next;
    }
    if (total(moved) < kSettled * kSettled) break;
  }
  for (std::size_t r = 0; r < count; ++r) along[r] = project(r);
  return true;
}

}  // namespace mocapress::qssd
