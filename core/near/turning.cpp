#include "near/turning.hpp"

#include <cmath>

#include "numbers/arithmetic.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// Whether the axes of an order follow each other as x, y, z do.
bool is_even(const Order& axes) { return (axes[0] + 1) % 3 == axes[1]; }

// The product of turns about axes, the outermost first.
Matrix turn_of(const Order& axes, const Angles& angles) {
  std::array<SineCosine, 3> turns;
  for (std::size_t i = 0; i < 3; ++i) turns[i] = sine_cosine(angles[i]);
  const auto& [a, b, c] = turns;
  const double sign = is_even(axes) ? 1 : -1;
  const auto [p, q, r] = axes;
  Matrix m;
  m[p][p] = b.cosine * c.cosine;
  m[p][q] = -(sign * (b.cosine * c.sine));
  m[p][r] = sign * b.sine;
  const double up = a.sine * b.sine, along = a.cosine * b.sine;
  m[q][p] = up * c.cosine + sign * (a.cosine * c.sine);
  m[q][q] = a.cosine * c.cosine - sign * (up * c.sine);
  m[q][r] = -(sign * (a.sine * b.cosine));
  m[r][p] = a.sine * c.sine - sign * (along * c.cosine);
  m[r][q] = along * c.sine + sign * (a.sine * c.cosine);
  m[r][r] = a.cosine * b.cosine;
  return m;
}

// The angles of a turn about axes, the second of which is at most a right angle.
Angles angles_of(const Order& axes, const Matrix& m) {
  const double sign = is_even(axes) ? 1 : -1;
  const auto [p, q, r] = axes;
  const double up = -(sign * m[q][r]), along = m[r][r];
  const double height = std::sqrt(up * up + along * along);
  const double sine = height > 0 ? up / height : 0, cosine = height > 0 ? along / height : 1;
  const double third_sine = sign * (cosine * m[q][p]) + sine * m[r][p];
  const double third_cosine = cosine * m[q][q] + sign * (sine * m[r][q]);
  return {arc_tangent(up, along), arc_tangent(sign * m[p][r], height),
          arc_tangent(third_sine, third_cosine)};
}

constexpr double kPi = 3.141592653589793;

// Of an angle and what is whole turns away from it, the nearest to another.
double near_to(double angle, double other, double turn) {
  return angle + turn * std::floor((other - angle) / turn + 0.5);
}

// Of the two ways to write a turn, with whole turns added, the one that is nearest to `last`.
Angles nearest_of(const Angles& angles, const Angles& last, double turn) {
  const double half = turn / 2;
  const Angles others = {angles[0] + half, half - angles[1], angles[2] + half};
  Angles one, two;
  double first = 0, second = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    one[i] = near_to(angles[i], last[i], turn);
    two[i] = near_to(others[i], last[i], turn);
    first += std::fabs(one[i] - last[i]);
    second += std::fabs(two[i] - last[i]);
  }
  return second < first ? two : one;
}

Angles scaled(const Angles& angles, double by) {
  return {angles[0] * by, angles[1] * by, angles[2] * by};
}

}  // namespace

Angles to_curves(const Turning& turning, bool radians, const Angles& file, const Angles& last) {
  const Order& columns = kOrders[turning.columns];
  const double in = radians ? 1 : kRadiansPerDegree, out = radians ? 1 : kDegreesPerRadian;
  const Angles turns = scaled({file[columns[0]], file[columns[1]], file[columns[2]]}, in);
  const Matrix m = turn_of(kOrders[turning.axes], turns);
  return nearest_of(scaled(angles_of(kOrders[turning.curves], m), out), last,
                    radians ? 2 * kPi : 360);
}

Angles to_file(const Turning& turning, bool radians, const Angles& curves, const Angles& last) {
  const Order& columns = kOrders[turning.columns];
  const double in = radians ? 1 : kRadiansPerDegree, out = radians ? 1 : kDegreesPerRadian;
  const Matrix m = turn_of(kOrders[turning.curves], scaled(curves, in));
  Angles turns = scaled(angles_of(kOrders[turning.axes], m), out);
  if (!turning.nearest_to_zero) {
    turns = nearest_of(turns, {last[columns[0]], last[columns[1]], last[columns[2]]},
                       radians ? 2 * kPi : 360);
  }
  Angles file;
  for (std::size_t i = 0; i < 3; ++i) file[columns[i]] = turns[i];
  return file;
}

}  // namespace mocapress::near
