// Unit quaternions of eight joints at a time, and their logarithms. All of it is additions,
// multiplications, divisions and square roots, lane by lane, so that every machine learns the same
// dictionary.
#pragma once

#include <cmath>

#include "numbers/lanes.hpp"

namespace mocapress::qssd {

// Eight unit quaternions [cos t/2; n sin t/2].
struct Turns {
  Block w, x, y, z;
};

// Eight vectors: logarithms n t/2, or axes.
struct Arcs {
  Block x, y, z;
};

struct Waves {
  Block sine, cosine;
};

MOCAPRESS_IN_PLACE Block root(Block squares) {
  Block roots;
  for (std::size_t i = 0; i < kLanes; ++i) roots[i] = std::sqrt(squares[i]);
  return roots;
}

// The lanes added up in one order.
MOCAPRESS_IN_PLACE double total(Block block) {
  return ((block[0] + block[1]) + (block[2] + block[3])) +
         ((block[4] + block[5]) + (block[6] + block[7]));
}

MOCAPRESS_IN_PLACE Block dot(const Arcs& a, const Arcs& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

MOCAPRESS_IN_PLACE Turns product(const Turns& a, const Turns& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

MOCAPRESS_IN_PLACE Turns conjugate(const Turns& a) { return {a.w, -a.x, -a.y, -a.z}; }

// Sine and cosine of angles of some turns, in radians: core/motion/angle.hpp, eight at a time.
MOCAPRESS_IN_PLACE Waves waves_of(Block angle) {
  constexpr double kToWhole = 6755399441055744.0;  // 1.5 * 2^52: sums with it are whole numbers
  constexpr double kQuarter = 0x1.921fb544p+0;
  constexpr double kQuarterRest = 0x1.0b4611a6p-34;
  const Block quarters = (angle * 0.6366197723675814 + kToWhole) - kToWhole;
  const Block r = (angle - quarters * kQuarter) - quarters * kQuarterRest;
  const Block q = r * r;
  const Block sine =
      r +
      r * q *
          (-1.0 / 6 +
           q * (1.0 / 120 + q * (-1.0 / 5040 + q * (1.0 / 362880 + q * (-1.0 / 39916800 +
                                                                        q * (1.0 / 6227020800))))));
  const Block cosine =
      1 + q * (-1.0 / 2 +
               q * (1.0 / 24 + q * (-1.0 / 720 +
                                    q * (1.0 / 40320 +
                                         q * (-1.0 / 3628800 +
                                              q * (1.0 / 479001600 + q * (-1.0 / 87178291200)))))));
  const Block turn = quarters - 4 * ((quarters * 0.25 + kToWhole) - kToWhole);  // -2 to 2
  const auto odd = turn * turn == 1.0;
  const auto half = turn * turn == 4.0;
  const Block first = odd ? cosine : sine;
  const Block second = odd ? sine : cosine;
  return {(half | (turn == -1.0)) ? -first : first, (half | (turn == 1.0)) ? -second : second};
}

// The arc tangent of over / under, from -pi/2 to pi/2; 0 where both are 0.
MOCAPRESS_IN_PLACE Block arc_of(Block over, Block under) {
  constexpr double kEighth = 0.41421356237309503;  // tan(pi/8)
  constexpr double kHalfPi = 1.5707963267948966;
  const Block a = over < 0 ? -over : over;
  const Block b = under < 0 ? -under : under;
  const auto steep = a > b;
  const Block low = steep ? b : a;
  const Block high = steep ? a : b;
  // The angle that is nearest of 0, pi/8 and pi/4, and what is left.
  const auto second = low > 0.198912367379658 * high;
  const auto third = low > 0.6681786379192989 * high;
  const Block zero{};
  const Block one = zero + 1.0;
  const Block tangent = third ? one : (second ? zero + kEighth : zero);
  const Block base = third ? zero + kHalfPi / 2 : (second ? zero + kHalfPi / 4 : zero);
  const Block below = high + tangent * low;
  const Block r = (low - tangent * high) / (below == 0 ? one : below);
  const Block q = r * r;
  const Block rest =
      r +
      r * q *
          (-1.0 / 3 +
           q * (1.0 / 5 +
                q * (-1.0 / 7 +
                     q * (1.0 / 9 +
                          q * (-1.0 / 11 +
                               q * (1.0 / 13 +
                                    q * (-1.0 / 15 +
                                         q * (1.0 / 17 + q * (-1.0 / 19 + q * (1.0 / 21))))))))));
  const Block angle = steep ? kHalfPi - (base + rest) : base + rest;
  return ((over < 0) ^ (under < 0)) ? -angle : angle;
}

// The logarithm of q or -q, whichever is the shorter turn.
MOCAPRESS_IN_PLACE Arcs logarithm(const Turns& a) {
  const Block sine = root(a.x * a.x + a.y * a.y + a.z * a.z);
  const Block per = arc_of(sine, a.w) / (sine == 0 ? Block{} + 1.0 : sine);
  return {per * a.x, per * a.y, per * a.z};
}

MOCAPRESS_IN_PLACE Turns exponential(const Arcs& a) {
  const Block angle = root(dot(a, a));
  const Waves waves = waves_of(angle);
  const Block per = waves.sine / (angle == 0 ? Block{} + 1.0 : angle);
  return {waves.cosine, per * a.x, per * a.y, per * a.z};
}

}  // namespace mocapress::qssd
