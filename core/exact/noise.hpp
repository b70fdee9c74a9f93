// Rounding noise around zero.
//
// A joint that a solver leaves alone has angles like -1.6201e-14: what remains of a difference of
// numbers near 1. In radians they are whole multiples of a power of two, k * 2^-(58 + q) with k
// odd, so k and q are coded: 7 to 11 bits in place of 23.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "coding/numbers.hpp"
#include "exact/codec.hpp"
#include "exact/tables.hpp"
#include "numbers/line.hpp"

namespace mocapress::exact {

class Noise {
 public:
  // Codes a number of such a column; any number comes back.
  template <class Side>
  double code(Side& side, const NumberLine& line, double number);

  template <class Visit>
  void visit(Visit&& each) {
    kinds_.visit(each);
    lengths_.visit(each);
  }

 private:
  BitTree<6> kinds_{kFirst.noise_kinds};
  BitTree<6> lengths_{kFirst.noise_lengths};
};

// The columns of noise of a clip, which come last.
class NoiseColumns {
 public:
  explicit NoiseColumns(std::span<const Column> columns);

  // How many columns there are before.
  std::size_t first() const { return first_; }
  std::size_t size() const { return columns_.size(); }

  template <class Side>
  void code(Side& side, double* row) {
    double* number = row + first_;
    for (auto& [line, noise] : columns_) {
      *number = noise.code(side, line, *number);
      ++number;
    }
  }

  template <class Visit>
  void visit(std::size_t column, Visit&& each) {
    columns_[column - first_].noise.visit(each);
  }

 private:
  struct NoiseColumn {
    NumberLine line;
    Noise noise;
  };

  std::size_t first_;
  std::vector<NoiseColumn> columns_;
};

}  // namespace mocapress::exact
