// Powers of ten and two, and what is done with them, the same on every machine.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace mocapress {

inline constexpr int kMostExactPower = 22;  // 10^22 is the last that a double holds exactly
inline constexpr int kLowestPower = -307;   // 10^-308 is no normal double
inline constexpr int kHighestPower = 308;

extern const std::array<double, kHighestPower - kLowestPower + 1> kPowersOfTen;

// 10^exponent, correctly rounded, from kLowestPower to kHighestPower.
inline double power_of_ten(int exponent) {
  return kPowersOfTen[static_cast<std::size_t>(exponent - kLowestPower)];
}

// For exponents from -1022 to 1023.
inline double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

constexpr std::int64_t integer_power(int base, int exponent) {
  std::int64_t power = 1;
  for (int i = 0; i < exponent; ++i) power *= base;
  return power;
}

// floor(log10(magnitude)) of a positive number, from kLowestPower to kHighestPower.
inline int decimal_exponent(double magnitude) {
  const int binary = static_cast<int>(std::bit_cast<std::uint64_t>(magnitude) >> 52) - 1023;
  const int exponent = (binary * 78913) >> 18;  // floor(binary * log10(2))
  if (exponent >= kHighestPower) return kHighestPower;
  if (exponent + 1 <= kLowestPower) return kLowestPower;
  return exponent + (magnitude >= power_of_ten(exponent + 1) ? 1 : 0);
}

inline constexpr double kRoundable = 0x1p51;

// To the nearest whole number, ties to even, for 0 <= value < kRoundable: no libm, no rounding
// mode.
inline double rounded(double value) {
  constexpr double kShift = 3 * kRoundable;
  return (value + kShift) - kShift;
}

}  // namespace mocapress
