// Sums of products for the prediction, many of them side by side: each is added up in the order in
// which docs/format/near.md says it, however wide the registers are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mocapress::near {

inline constexpr std::size_t kGroup = 64;          // frames that are learned from together
inline constexpr std::size_t kWaves = kGroup - 1;  // of such a group
inline constexpr std::size_t kReach = 6;           // frames to both sides of an average
inline constexpr std::size_t kFill = 8;            // rows below are filled up to so many
inline std::size_t filled(std::size_t count) { return (count + kFill - 1) / kFill * kFill; }

// Bands of the waves from 1 on, by their last. A channel's waves of a band count equally.
inline constexpr std::array<std::size_t, 9> kBandEnds = {1, 2, 3, 5, 8, 12, 20, 32, 63};
inline constexpr std::size_t kWaveBands = kBandEnds.size();

// The waves of `count` columns, a filled number, of which kFill stand in rows side by side, then
// the next kFill: waves in kWaves rows, numbers in kGroup rows, of which the first half has the
// sums of frames and of those as far from the end, the other the differences.
void waves_of(const double* numbers, std::size_t count, double* waves);

// A product of two channels, `column` at or before `row`, as `channel` uses it: of what both moved
// and of their averages, four numbers.
struct Use {
  std::uint32_t row, column, channel, place;
};

// Puts uses in an order in which those that are next to each other share their products.
void sort_uses(std::vector<Use>& uses, std::size_t channels);

// Of waves, two columns for each channel: adds to the four numbers at `place` of `sums`, for each
// band in turn, the sums of products in it times the weight of the band, of which every channel has
// kWaveBands.
void add_products(const double* waves, const std::vector<Use>& uses, const double* weights,
                  double* sums);

// The sum of shares of features, in `length` frames, a multiple of 8.
void weigh(const double* const* features, const double* shares, std::size_t count,
           std::size_t length, double* sums);

// 49 times the averages around `length` numbers, a multiple of 8, with kReach to both sides.
void average(const double* numbers, std::size_t length, double* sums);

// Solves m equations of a symmetric matrix, in rows of filled(m + 1) of which the upper half is
// told and, behind it, the right side; below the diagonal is 0. False where it is not positive.
bool solve(double* matrix, double* x, std::size_t m);

}  // namespace mocapress::near
