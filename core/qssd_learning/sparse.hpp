// What a frame is put together from: a few atoms of a dictionary, each with a weight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mocapress::qssd {

inline constexpr std::size_t kMostAtoms = 64;  // of a frame

// One frame's atoms; -1 and 0 behind the last.
struct Picked {
  std::span<std::int32_t> atoms;
  std::span<double> weights;

  std::size_t count() const {
    return static_cast<std::size_t>(std::find(atoms.begin(), atoms.end(), -1) - atoms.begin());
  }
};

// Whether an atom is multiplied before another (Eq. 2): by magnitude, of equal ones the first of
// the dictionary.
inline bool before(std::int32_t atom, double weight, std::int32_t other, double its_weight) {
  const double a = std::fabs(weight), b = std::fabs(its_weight);
  return a != b ? a > b : atom < other;
}

// Brings a frame's atoms into the order of their product.
inline bool put_in_order(const Picked& picked, std::size_t count) {
  bool moved = false;
  for (std::size_t i = 1; i < count; ++i) {
    for (std::size_t j = i; j > 0; --j) {
      if (!before(picked.atoms[j], picked.weights[j], picked.atoms[j - 1], picked.weights[j - 1]))
        break;
      std::swap(picked.atoms[j], picked.atoms[j - 1]);
      std::swap(picked.weights[j], picked.weights[j - 1]);
      moved = true;
    }
  }
  return moved;
}

}  // namespace mocapress::qssd
