// Rounding noise around zero.
//
// A joint that a solver leaves alone has angles like -1.6201e-14: what remains of a difference of
// numbers near 1. In radians they are whole multiples of a power of two, k * 2^-(58 + q) with k
// odd, so k and q are coded: 7 to 11 bits in place of 23.
#pragma once

#include <array>
#include <cstdint>

#include "exact/sides.hpp"
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

}  // namespace mocapress::exact
