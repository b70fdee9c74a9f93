// Functions of additions, multiplications, divisions and square roots alone, so that every machine
// gives the same bits. Logarithm and exponential are coarse, to about 6 %, which is as good
// as the models need that use them; the trigonometric ones are good to about 1e-14.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "numbers/lanes.hpp"

namespace mocapress {

inline constexpr double kLn2 = 0.6931471805599453;
inline constexpr double kRadiansPerDegree = 0.017453292519943295;
inline constexpr double kDegreesPerRadian = 57.29577951308232;

// Natural logarithm of a normal, positive number as if it were linear from one power of two to the
// next.
inline double natural_log(double value) {
  const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(value) >> 12);
  return static_cast<double>(bits - (std::int64_t{1023} << 40)) * (kLn2 / 1099511627776.0);
}

// The same of eight.
MOCAPRESS_IN_PLACE Block natural_log(Block values) {
  using Bits = std::uint64_t __attribute__((vector_size(sizeof(Block))));
  // A whole number below 2^52 in the lowest bits of 2^52 as a double.
  const Bits bits = std::bit_cast<Bits>(values) >> 12 | 0x4330000000000000;
  const Block wholes = std::bit_cast<Block>(bits) - (4503599627370496.0 + 1023 * 1099511627776.0);
  return wholes * (kLn2 / 1099511627776.0);
}

// The inverse, for -700 <= value <= 700.
inline double natural_exp(double value) {
  constexpr double kOne = 4503599627370496.0;
  const double bits = value * (kOne / kLn2) + 1023 * kOne;
  return std::bit_cast<double>(static_cast<std::int64_t>(bits));
}

inline constexpr double kHalfPi = 1.5707963267948966, kHalfPiRest = 6.123233995736766e-17;
// atan(k / 8); 16, so that four bits are always an index.
inline constexpr double kEighthAngles[16] = {0,
                                             0.12435499454676144,
                                             0.24497866312686414,
                                             0.3587706702705722,
                                             0.4636476090008061,
                                             0.5585993153435624,
                                             0.6435011087932844,
                                             0.7188299996216245,
                                             0.7853981633974483};

// Series, of doubles and of vectors of them: sine and cosine within an eighth of a turn, and the
// angle of a tangent of at most 1/16.
template <class Number>
MOCAPRESS_IN_PLACE Number sine_series(Number x) {
  const Number q = x * x;
  return x * (1.0 - q * (1.0 / 6) *
                        (1.0 - q * (1.0 / 20) *
                                   (1.0 - q * (1.0 / 42) *
                                              (1.0 - q * (1.0 / 72) *
                                                         (1.0 - q * (1.0 / 110) *
                                                                    (1.0 - q * (1.0 / 156)))))));
}

template <class Number>
MOCAPRESS_IN_PLACE Number cosine_series(Number x) {
  const Number q = x * x;
  return 1.0 -
         q * (1.0 / 2) *
             (1.0 - q * (1.0 / 12) *
                        (1.0 - q * (1.0 / 30) *
                                   (1.0 - q * (1.0 / 56) *
                                              (1.0 - q * (1.0 / 90) *
                                                         (1.0 - q * (1.0 / 132) *
                                                                    (1.0 - q * (1.0 / 182)))))));
}

template <class Number>
MOCAPRESS_IN_PLACE Number arc_series(Number t) {
  const Number q = t * t;
  return t * (1.0 - q * (1.0 / 3 -
                         q * (1.0 / 5 -
                              q * (1.0 / 7 - q * (1.0 / 9 - q * (1.0 / 11 - q * (1.0 / 13)))))));
}

struct SineCosine {
  double sine, cosine;
};

// Of an angle in radians; of 0 where it is beyond 1e6 or no number.
inline SineCosine sine_cosine(double angle) {
  if (!(std::fabs(angle) <= 1e6)) angle = 0;
  const double turns = angle * (1 / kHalfPi);
  const auto quarter = static_cast<std::int64_t>(turns + (turns < 0 ? -0.5 : 0.5));
  const auto whole = static_cast<double>(quarter);
  const double x = (angle - whole * kHalfPi) - whole * kHalfPiRest;  // |x| <= pi / 4
  const double sine = sine_series(x), cosine = cosine_series(x);
  switch (quarter & 3) {
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

// The angle of (x, y), in radians; 0 of (0, 0).
inline double arc_tangent(double y, double x) {
  constexpr double kPi = 3.141592653589793;
  const double up = std::fabs(y);
  const double along = std::fabs(x);
  const bool steep = up > along;
  const double low = steep ? along : up;
  const double high = steep ? up : along;
  if (!(high > 0)) return 0;
  const double ratio = low / high;
  const auto eighth = static_cast<int>(ratio * 8 + 0.5);
  const double near = eighth / 8.0;
  const double t = (ratio - near) / (1 + ratio * near);  // |t| <= 1 / 16
  double angle = kEighthAngles[eighth] + arc_series(t);
  if (steep) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

// In radians, of a sine that is cut to -1 to 1.
inline double arc_sine(double sine) {
  const double cut = sine > 1 ? 1 : sine < -1 ? -1 : sine;
  return arc_tangent(cut, std::sqrt((1 - cut) * (1 + cut)));
}

}  // namespace mocapress
