// Unit quaternions, scalar first, by operations that have the same bits everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "coding/fail.hpp"
#include "motion/angle.hpp"

namespace mocapress::qssd {

using Quaternion = std::array<double, 4>;

inline constexpr Quaternion kNoTurn = {1, 0, 0, 0};

inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

inline Quaternion conjugate(const Quaternion& a) { return {a[0], -a[1], -a[2], -a[3]}; }

inline double dot(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

inline double length(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

// About an axis of length 1, by so few turns that they are one of motion.
inline Quaternion about(const std::array<double, 3>& axis, double half_angle) {
  if (!(std::fabs(half_angle) <= 1e6)) fail("an angle of more turns than any motion has");
  const Turn turn = turn_of_radians(half_angle);
  return {turn.cosine, turn.sine * axis[0], turn.sine * axis[1], turn.sine * axis[2]};
}

inline Quaternion exponential(double x, double y, double z) {
  const double half = length(x, y, z);
  if (half == 0) return kNoTurn;
  return about({x / half, y / half, z / half}, half);
}

// The angle of the point (x, y), radians, from -pi to pi; 0 for (0, 0).
inline double angle_of(double y, double x) {
  constexpr double kPi = 3.141592653589793;
  const double a = std::fabs(y), b = std::fabs(x);
  const double low = std::min(a, b), high = std::max(std::max(a, b), 1e-300);
  double tangent = 0, base = 0;  // the nearest of 0, pi/8 and pi/4
  if (low > 0.6681786379192989 * high) {
    tangent = 1;
    base = kPi / 4;
  } else if (low > 0.198912367379658 * high) {
    tangent = 0.41421356237309503;
    base = kPi / 8;
  }
  const double r = (low - tangent * high) / (high + tangent * low);
  const double q = r * r;
  double series = 1.0 / 21;
  for (int n = 19; n > 0; n -= 2) series = 1.0 / n - q * series;
  double angle = base + r * series;
  if (a > b) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

}  // namespace mocapress::qssd
