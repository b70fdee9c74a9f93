// One angle of a joint from its others, where the joint has fewer than three degrees of freedom.
//
// R = T0 T1 T2 is the rotation of a joint, its turns in the order of its columns. Where a direction
// v of the bone and a direction u of its parent keep their angle, u' R v = c, and the angle x of
// one turn solves A cos x + B sin x = C.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "motion/vector.hpp"

namespace mocapress::exact {

class Joint {
 public:
  static constexpr int kKind = 5;  // of a coupling, beside those of LawKind
  // Shape, u, v, c; the shape is axes + 27 (target + 3 source): the axes of the turns (0 to 2: x to
  // z) as a number of base 3, the first turn's last, and which turn the target and the first source
  // are.
  static constexpr std::size_t kParameters = 8;
  static constexpr double kLargest = 2;  // of u and v, and half of that of c

  static bool exists(std::size_t sources, std::span<const double> parameters);

  Joint(std::size_t sources, std::span<const double> parameters);

  struct Angles {
    double one, other;  // in degrees, up to whole turns
    double looseness;   // how far they move when u' R v, of unit vectors, moves by one radian
  };

  // What the target may be; `unknown` where anything would do. The sources are one or two of the
  // other angles; one that is missing must not matter.
  Angles angles(const double* sources, double unknown) const;

 private:
  std::size_t sources_;
  std::array<std::size_t, 3> axes_{};
  std::size_t target_;
  std::array<std::size_t, 2> places_{};  // which turns the sources are
  Vector u_, v_;
  double c_;
  double length_;  // of u times that of v
};

}  // namespace mocapress::exact
