// Sums of products for the prediction, many of them side by side: each is added up in the order in
// which docs/format/near.md says it, however wide the registers are.
#pragma once

#include <cstddef>

namespace mocapress::near {

inline constexpr std::size_t kGroup = 64;          // frames that are learned from together
inline constexpr std::size_t kWaves = kGroup - 1;  // of such a group
inline constexpr std::size_t kReach = 6;           // frames to both sides of an average
inline constexpr std::size_t kFill = 8;            // rows below are filled up to so many
inline std::size_t filled(std::size_t count) { return (count + kFill - 1) / kFill * kFill; }

// The waves of `count` columns, a filled number: numbers are kGroup rows, waves kWaves rows.
void waves_of(const double* numbers, std::size_t count, double* waves);

// For each of kWaves rows of `count` features, a filled number, and of these weighed, in turn: adds
// to the upper half of a matrix the products of every feature with those weighed that do not stand
// before it, and to `sums` the products of those weighed with the row's aim.
void add_products(const double* features, const double* weighed, const double* aims,
                  std::size_t count, double* matrix, double* sums);

// The sum of shares of features, in `length` frames, a multiple of 8.
void weigh(const double* const* features, const double* shares, std::size_t count,
           std::size_t length, double* sums);

// 49 times the averages around `length` numbers, a multiple of 8, with kReach to both sides.
void average(const double* numbers, std::size_t length, double* sums);

// Solves the equations of a symmetric matrix, in rows of filled(m) of which the upper half is told;
// false where it is not positive.
bool solve(double* matrix, double* x, std::size_t m);

}  // namespace mocapress::near
