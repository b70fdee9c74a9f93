#include "near/turning.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "numbers/arithmetic.hpp"
#include "numbers/wide.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

using Two = double __attribute__((vector_size(2 * sizeof(double))));
using Four = double __attribute__((vector_size(4 * sizeof(double))));
template <class Vector>
inline constexpr std::size_t kWidth = sizeof(Vector) / sizeof(double);
// Whole numbers beside these, as wide and half as wide.
template <class Vector>
struct Whole;
template <>
struct Whole<Two> {
  using Wide = std::int64_t __attribute__((vector_size(2 * sizeof(std::int64_t))));
  using Half = std::int32_t __attribute__((vector_size(2 * sizeof(std::int32_t))));
};
template <>
struct Whole<Four> {
  using Wide = std::int64_t __attribute__((vector_size(4 * sizeof(std::int64_t))));
  using Half = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));
};

// Numbers of several frames side by side, with which everything is done as with one.
template <class Vector>
struct SinesCosines {
  Vector sine, cosine;
};

// sine_cosine of each.
template <class Vector>
MOCAPRESS_IN_PLACE SinesCosines<Vector> sines_cosines(Vector angles) {
  angles = ((angles <= 1e6) & (angles >= -1e6)) ? angles : Vector{};
  const Vector turns = angles * (1 / kHalfPi);
  const Vector half = Vector{} + 0.5;
  const auto near =
      __builtin_convertvector(turns + (turns < 0.0 ? -half : half), typename Whole<Vector>::Half);
  const Vector whole = __builtin_convertvector(near, Vector);
  const auto quarter = __builtin_convertvector(near, typename Whole<Vector>::Wide);
  const Vector x = (angles - whole * kHalfPi) - whole * kHalfPiRest;
  const Vector sine = sine_series(x), cosine = cosine_series(x);
  const auto odd = (quarter & 1) != 0;
  const Vector one = odd ? cosine : sine, other = odd ? sine : cosine;
  return {(quarter & 2) != 0 ? -one : one, ((quarter + 1) & 2) != 0 ? -other : other};
}

template <class Vector>
MOCAPRESS_IN_PLACE Vector magnitudes(Vector numbers) {
  constexpr auto kNoSign = std::int64_t{0x7fffffffffffffff};
  return std::bit_cast<Vector>(std::bit_cast<typename Whole<Vector>::Wide>(numbers) & kNoSign);
}

// arc_tangent of each, all of which are finite.
template <class Vector>
MOCAPRESS_IN_PLACE Vector arc_tangents(Vector y, Vector x) {
  constexpr double kPi = 3.141592653589793;
  const Vector up = magnitudes(y), along = magnitudes(x);
  const auto steep = up > along;
  const Vector low = steep ? along : up, high = steep ? up : along;
  const auto is_there = high > 0.0;
  const Vector ratio = low / (is_there ? high : Vector{} + 1.0);
  const auto eighth = __builtin_convertvector(ratio * 8.0 + 0.5, typename Whole<Vector>::Half);
  const Vector near = __builtin_convertvector(eighth, Vector) / 8.0;
  const Vector t = (ratio - near) / (1.0 + ratio * near);
  Vector angle;
  for (std::size_t i = 0; i < kWidth<Vector>; ++i) angle[i] = kEighthAngles[eighth[i] & 15];
  angle += arc_series(t);
  angle = steep ? kPi / 2 - angle : angle;
  angle = x < 0.0 ? kPi - angle : angle;
  angle = y < 0.0 ? -angle : angle;
  return is_there ? angle : Vector{};
}

MOCAPRESS_IN_PLACE SinesCosines<double> sines_cosines(double angle) {
  const SineCosine own = sine_cosine(angle);
  return {own.sine, own.cosine};
}
MOCAPRESS_IN_PLACE double arc_tangents(double y, double x) { return arc_tangent(y, x); }

template <class Number>
using AnglesOf = std::array<Number, 3>;
template <class Number>
using Matrix = std::array<AnglesOf<Number>, 3>;

// Whether the axes of an order follow each other as x, y, z do.
bool is_even(const Order& axes) { return (axes[0] + 1) % 3 == axes[1]; }

// The product of turns about axes, the outermost first.
template <class Number>
MOCAPRESS_IN_PLACE Matrix<Number> turn_of(const Order& axes, const AnglesOf<Number>& angles) {
  const auto a = sines_cosines(angles[0]), b = sines_cosines(angles[1]),
             c = sines_cosines(angles[2]);
  const double sign = is_even(axes) ? 1 : -1;
  const auto [p, q, r] = axes;
  Matrix<Number> m;
  m[p][p] = b.cosine * c.cosine;
  m[p][q] = -(sign * (b.cosine * c.sine));
  m[p][r] = sign * b.sine;
  const Number up = a.sine * b.sine, along = a.cosine * b.sine;
  m[q][p] = up * c.cosine + sign * (a.cosine * c.sine);
  m[q][q] = a.cosine * c.cosine - sign * (up * c.sine);
  m[q][r] = -(sign * (a.sine * b.cosine));
  m[r][p] = a.sine * c.sine - sign * (along * c.cosine);
  m[r][q] = along * c.sine + sign * (a.sine * c.cosine);
  m[r][r] = a.cosine * b.cosine;
  return m;
}

MOCAPRESS_IN_PLACE double root_of(double number) { return std::sqrt(number); }
template <class Vector>
MOCAPRESS_IN_PLACE Vector root_of(Vector numbers) {
  for (std::size_t i = 0; i < kWidth<Vector>; ++i) numbers[i] = std::sqrt(numbers[i]);
  return numbers;
}

// The angles of a turn about axes, the second of which is at most a right angle.
template <class Number>
MOCAPRESS_IN_PLACE AnglesOf<Number> angles_of(const Order& axes, const Matrix<Number>& m) {
  const double sign = is_even(axes) ? 1 : -1;
  const auto [p, q, r] = axes;
  const Number up = -(sign * m[q][r]), along = m[r][r];
  const Number height = root_of(up * up + along * along);
  const Number none = Number{}, one = none + 1.0;
  const Number sine = height > 0.0 ? up / height : none,
               cosine = height > 0.0 ? along / height : one;
  const Number third_sine = sign * (cosine * m[q][p]) + sine * m[r][p];
  const Number third_cosine = cosine * m[q][q] + sign * (sine * m[r][q]);
  return {arc_tangents(up, along), arc_tangents(Number(sign * m[p][r]), height),
          arc_tangents(third_sine, third_cosine)};
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

template <class Number>
MOCAPRESS_IN_PLACE AnglesOf<Number> scaled(const AnglesOf<Number>& angles, double by) {
  return {angles[0] * by, angles[1] * by, angles[2] * by};
}

// The file's angles of as many frames as a vector has numbers, which lie `next` numbers apart; in
// the order in which they turn.
template <class Vector>
MOCAPRESS_IN_PLACE void turn_frames(const Turning& turning, bool radians, double* own,
                                    std::size_t next) {
  AnglesOf<Vector> angles;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t f = 0; f < kWidth<Vector>; ++f) angles[i][f] = own[f * next + i];
  }
  const double in = radians ? 1 : kRadiansPerDegree, out = radians ? 1 : kDegreesPerRadian;
  const auto m = turn_of<Vector>(kOrders[turning.curves], scaled<Vector>(angles, in));
  angles = scaled<Vector>(angles_of<Vector>(kOrders[turning.axes], m), out);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t f = 0; f < kWidth<Vector>; ++f) own[f * next + i] = angles[i][f];
  }
}

template <class Vector>
MOCAPRESS_IN_PLACE void turn_with(const Turning& turning, bool radians, double* own,
                                  std::size_t next, std::size_t frames) {
  constexpr std::size_t kCount = kWidth<Vector>;
  std::size_t f = 0;
  for (; f + kCount <= frames; f += kCount) {
    turn_frames<Vector>(turning, radians, own + f * next, next);
  }
  if (f == frames) return;
  double rest[3 * kCount] = {};
  for (std::size_t k = f; k < frames; ++k) std::copy_n(own + k * next, 3, rest + 3 * (k - f));
  turn_frames<Vector>(turning, radians, rest, 3);
  for (std::size_t k = f; k < frames; ++k) std::copy_n(rest + 3 * (k - f), 3, own + k * next);
}

MOCAPRESS_WIDE void wide_turn(const Turning& turning, bool radians, double* own, std::size_t next,
                              std::size_t frames) {
  turn_with<Four>(turning, radians, own, next, frames);
}

}  // namespace

Angles to_curves(const Turning& turning, bool radians, const Angles& file, const Angles& last) {
  const Order& columns = kOrders[turning.columns];
  const double in = radians ? 1 : kRadiansPerDegree, out = radians ? 1 : kDegreesPerRadian;
  const Angles turns = scaled<double>({file[columns[0]], file[columns[1]], file[columns[2]]}, in);
  const auto m = turn_of<double>(kOrders[turning.axes], turns);
  return nearest_of(scaled<double>(angles_of<double>(kOrders[turning.curves], m), out), last,
                    radians ? 2 * kPi : 360);
}

void to_file(const Turning& turning, bool radians, double* rows, std::size_t columns,
             std::size_t frames, Angles last) {
  const Order& order = kOrders[turning.columns];
  double* const own = rows + turning.first;
  if (is_wide()) {
    wide_turn(turning, radians, own, columns, frames);
  } else {
    turn_with<Two>(turning, radians, own, columns, frames);
  }
  last = {last[order[0]], last[order[1]], last[order[2]]};
  for (std::size_t f = 0; f < frames; ++f) {
    double* const frame = own + f * columns;
    Angles turns = {frame[0], frame[1], frame[2]};
    if (!turning.nearest_to_zero) {
      turns = last = nearest_of(turns, last, radians ? 2 * kPi : 360);
    }
    for (std::size_t i = 0; i < 3; ++i) frame[order[i]] = turns[i];
  }
}

}  // namespace mocapress::near
