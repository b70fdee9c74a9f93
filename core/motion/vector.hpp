// Vectors and matrices of three, in one order of additions.
#pragma once

#include <array>

namespace mocapress {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // its columns

inline constexpr Matrix kIdentity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

inline double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline Vector sum(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

inline Vector scaled(const Vector& a, double by) { return {a[0] * by, a[1] * by, a[2] * by}; }

inline Vector turned(const Matrix& m, const Vector& a) {
  return sum(sum(scaled(m[0], a[0]), scaled(m[1], a[1])), scaled(m[2], a[2]));
}

inline Matrix product(const Matrix& a, const Matrix& b) {
  return {turned(a, b[0]), turned(a, b[1]), turned(a, b[2])};
}

inline Matrix transposed(const Matrix& m) {
  return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
}

}  // namespace mocapress
