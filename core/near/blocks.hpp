// Curves of a channel: blocks of frames, each a line between two knots and sines upon it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coding/bit.hpp"
#include "near/turning.hpp"

namespace mocapress::near {

inline constexpr int kLongest = 256;  // frames of a block, and of a long span of all channels
inline constexpr int kShortSpan = 64;
inline constexpr int kShortest = 8;
// Up to which sine a block has coefficients, by its class.
inline constexpr std::array<int, 17> kEnds = {0,  1,  2,  3,  4,  6,   8,   11, 16,
                                              22, 32, 45, 64, 90, 128, 181, 255};

// Frames of a span where so many are left. After each, channels have learned to foretell each other
// a little better.
inline int span_of(bool is_short, std::size_t left) {
  int length = is_short ? kShortSpan : kLongest;
  while (length > kShortest && static_cast<std::size_t>(length / 2) >= left) length /= 2;
  return length;
}

// How many classes a block of so many frames has.
inline int classes_of(int length) {
  int count = 0;
  while (kEnds[static_cast<std::size_t>(count)] < length - 1) ++count;
  return count + 1;
}

inline int end_of(int of_class, int length) {
  return std::min(kEnds[static_cast<std::size_t>(of_class)], length - 1);
}

struct Block {
  int start, length;  // in frames of the span
  int of_class = 0;
  // Its knot at [0], then its sines: `length` numbers within the channel's of the span.
  std::int32_t* numbers = nullptr;
};

// Sines are rounded by two quantisers in turn, one with the even multiples of half a step, one with
// the odd ones and 0. Which is next follows from which numbers before were odd, by eight states.
inline constexpr std::array<std::array<std::uint8_t, 2>, 8> kNextState = {
    {{0, 2}, {2, 0}, {4, 6}, {6, 4}, {5, 7}, {7, 5}, {1, 3}, {3, 1}}};
inline constexpr double kHalfStep = 0.5625;  // in steps of the channel

inline std::size_t next_state(std::size_t state, std::int32_t number) {
  return kNextState[state][number & 1];
}

inline bool is_odd(std::size_t state) { return state >= 4; }

// How many steps high a sine of this number is.
inline double height_of(std::int32_t number, bool odd) {
  const int nearer = !odd || number == 0 ? 0 : number < 0 ? -1 : 1;
  return (2.0 * number - nearer) * kHalfStep;
}

// Columns and what moves together with them: the joint of each, and the parent of each joint, both
// counted in the order in which columns tell them.
struct Joints {
  std::vector<std::int32_t> of_column;
  std::vector<std::int32_t> parents;  // smaller than the joint; -1 for none
};

struct Start;

// What all channels of a clip share, and what each has of its own.
struct Plan {
  const Start* start = nullptr;  // what coders begin with; none for nothing
  bool short_spans = true;       // or long ones
  double knot = 0.5;             // the step of knots, in steps of the channel
  std::vector<double> steps;
  Joints joints;
  std::vector<Turning> turnings;
  std::vector<double> firsts;  // what channels begin near to; nothing for 0
  bool radians = false;
  std::vector<std::size_t> order;  // of the file's columns, which each is; nothing for 0, 1, ...

  double first_of(std::size_t column) const { return firsts.empty() ? 0 : firsts[column]; }
};

// 2^(exponent / 64), for -4096 <= exponent <= 4096.
double step_of(int exponent);

// The channel in the frames of a block that begins behind `left`.
void draw(const Block& block, double left, double step, const Plan& plan, double* curve);

// sqrt(2 / n) sin(pi k t / n) for t = 1 .. n - 1, of k = 1 .. n - 1; n a power of two.
std::span<const double> sine(int length, int k);

}  // namespace mocapress::near
