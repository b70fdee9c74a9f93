#include "numbers/snap.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>

namespace mocapress {
namespace {

// All that are exact in a double.
constexpr std::array kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                     1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                     1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::array kTenths = {1e0,   1e-1,  1e-2,  1e-3,  1e-4,  1e-5,  1e-6,  1e-7,
                                1e-8,  1e-9,  1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15,
                                1e-16, 1e-17, 1e-18, 1e-19, 1e-20, 1e-21, 1e-22};
constexpr int kExact = 22;
constexpr double kRoundable = 2251799813685248.0;  // 2^51

// To the nearest whole number, ties to even, for 0 <= value < 2^51: no libm, no rounding mode.
double rounded(double value) {
  const double shift = 3 * kRoundable;
  return (value + shift) - shift;
}

// Correct for any exponent, but slow.
double snap_text(double value, int digits) {
  std::array<char, 64> text;
  const auto printed = std::to_chars(text.data(), text.data() + text.size(), value,
                                     std::chars_format::scientific, digits - 1);
  double number = value;
  std::from_chars(text.data(), printed.ptr, number);
  return number;
}

double snap_shortest32(double value) {
  std::array<char, 64> text;
  const auto printed =
      std::to_chars(text.data(), text.data() + text.size(), static_cast<float>(value),
                    std::chars_format::scientific);  // fixed may print more digits than needed
  double number = value;
  std::from_chars(text.data(), printed.ptr, number);
  return number;
}

double snap_decimals(double value, int decimals) {
  if (decimals < 0 || decimals > kExact) return value;
  const double scaled = std::fabs(value) * kPowersOfTen[decimals];
  if (!(scaled < kRoundable)) return value;
  return std::copysign(rounded(scaled) / kPowersOfTen[decimals], value);
}

// floor(log10(magnitude)), where that is from -22 to 21.
int decimal_exponent(double magnitude) {
  const int binary = static_cast<int>(std::bit_cast<std::uint64_t>(magnitude) >> 52) - 1023;
  const int exponent = (binary * 78913) >> 18;  // floor(binary * log10(2))
  const int next = exponent + 1;
  if (next < -kExact || next > kExact) return exponent;
  return exponent + (magnitude >= (next < 0 ? kTenths[-next] : kPowersOfTen[next]) ? 1 : 0);
}

double snap_significant(double value, int digits) {
  if (digits < 1 || digits > 15) return value;
  const double magnitude = std::fabs(value);
  const int decimals = digits - 1 - decimal_exponent(magnitude);
  double number;
  if (0 <= decimals && decimals <= kExact) {
    number = rounded(magnitude * kPowersOfTen[decimals]) / kPowersOfTen[decimals];
  } else if (-kExact <= decimals && decimals < 0) {
    number = rounded(magnitude / kPowersOfTen[-decimals]) * kPowersOfTen[-decimals];
  } else {
    number = snap_text(magnitude, digits);
  }
  return std::copysign(number, value);
}

}  // namespace

double snap(double value, Grid grid, int digits) {
  if (value == 0 || !(std::fabs(value) <= 1.7976931348623157e308)) return value;
  switch (grid) {
    case Grid::significant:
      return snap_significant(value, digits);
    case Grid::decimals:
      return snap_decimals(value, digits);
    case Grid::shortest32:
      return snap_shortest32(value);
    default:
      return value;
  }
}

}  // namespace mocapress
