// Sine and cosine by additions and multiplications alone, so that every machine and every build
// gives the same bits; within 2e-16 of the true value for angles of some turns.
#pragma once

#include <cmath>
#include <cstdint>

namespace mocapress {

struct Turn {
  double sine, cosine;
};

// Of an angle of at most half a right angle and so many right angles, in radians.
inline Turn turn_of(double x, std::int64_t quarters) {
  const double q = x * x;
  const double sine =
      x + x * q *
              (-1.0 / 6 +
               q * (1.0 / 120 + q * (-1.0 / 5040 +
                                     q * (1.0 / 362880 + q * (-1.0 / 39916800 +
                                                              q * (1.0 / 6227020800 +
                                                                   q * (-1.0 / 1307674368000)))))));
  const double cosine =
      1 + q * (-1.0 / 2 +
               q * (1.0 / 24 +
                    q * (-1.0 / 720 +
                         q * (1.0 / 40320 +
                              q * (-1.0 / 3628800 +
                                   q * (1.0 / 479001600 +
                                        q * (-1.0 / 87178291200 + q * (1.0 / 20922789888000))))))));
  switch (quarters & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

inline std::int64_t nearest(double value) {
  return static_cast<std::int64_t>(value + (value < 0 ? -0.5 : 0.5));
}

// Of an angle in degrees; what is no finite number gives none.
inline Turn turn_of_degrees(double angle) {
  constexpr double kRadians = 0.017453292519943295;
  if (!std::isfinite(angle)) return {angle - angle, angle - angle};
  if (std::fabs(angle) > 1e12) angle = std::fmod(angle, 360);  // exact, as all that follows
  const std::int64_t quarters = nearest(angle / 90);
  return turn_of((angle - 90 * static_cast<double>(quarters)) * kRadians, quarters);
}

// Of an angle in radians.
inline Turn turn_of_radians(double angle) {
  // A quarter turn in three parts, of which the first two have 33 bits: they are exact times 2^20.
  constexpr double kQuarter = 0x1.921fb544p+0;
  constexpr double kQuarterRest = 0x1.0b4611a6p-34;
  constexpr double kQuarterLast = 0x1.3198a2e037073p-69;
  if (!std::isfinite(angle)) return {angle - angle, angle - angle};
  // Nothing of motion turns that far; which angle it is means nothing any more.
  if (std::fabs(angle) > 1e6) angle = std::fmod(angle, 6.283185307179586);
  const std::int64_t quarters = nearest(angle / kQuarter);
  const auto count = static_cast<double>(quarters);
  const double x = ((angle - count * kQuarter) - count * kQuarterRest) - count * kQuarterLast;
  return turn_of(x, quarters);
}

}  // namespace mocapress
