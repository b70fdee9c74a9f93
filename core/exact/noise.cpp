#include "exact/noise.hpp"

#include <bit>
#include <cmath>

#include "exact_fast/sides.hpp"

namespace mocapress::exact {
namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr int kLowest = -12;  // the smallest q
constexpr unsigned kZero = 62;
constexpr unsigned kOther = 63;
constexpr int kMostBits = 20;  // of k
constexpr double kMostMultiple = 1e6;
constexpr int kLongest = 40;  // the finest kind: lengths count from what it would have

double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

// A number taken apart: of kind q - kLowest, kZero or kOther.
struct Multiple {
  unsigned kind;
  bool negative;
  std::uint64_t half;  // (|k| - 1) / 2
};

double number_of(const Multiple& multiple, const NumberLine& line) {
  if (multiple.kind == kZero) return multiple.negative ? -0.0 : 0.0;
  const double radians = static_cast<double>(2 * multiple.half + 1) *
                         power_of_two(-58 - kLowest - static_cast<int>(multiple.kind));
  const double degrees = line.number(line.place(radians * kDegrees));
  return multiple.negative ? -degrees : degrees;
}

Multiple multiple_of(double number, const NumberLine& line) {
  const bool negative = std::signbit(number);
  if (number == 0) return {kZero, negative, 0};
  const double radians = std::fabs(number) / kDegrees;
  for (unsigned kind = 0; kind <= kLongest; ++kind) {
    const double times = radians * power_of_two(58 + kLowest + static_cast<int>(kind));
    if (times > kMostMultiple) break;
    const auto whole = static_cast<std::uint64_t>(times + 0.5);
    const Multiple multiple{kind, negative, whole / 2};
    if (whole % 2 == 1 && number_of(multiple, line) == number) return multiple;
  }
  return {kOther, negative, 0};
}

}  // namespace

template <class Side>
double Noise::code(Side& side, const NumberLine& line, double number) {
  Multiple multiple{};
  if constexpr (!Side::kReading) multiple = multiple_of(number, line);
  multiple.kind = side.symbol(kinds_, multiple.kind);
  if (multiple.kind == kOther) {
    return std::bit_cast<double>(side.raw(64, std::bit_cast<std::uint64_t>(number)));
  }
  multiple.negative = side.raw(1, multiple.negative ? 1 : 0) != 0;
  if (multiple.kind == kZero) return number_of(multiple, line);
  // The numbers are of one size, whatever the unit: the finer it is, the longer is k.
  const int finer = static_cast<int>(multiple.kind) - kLongest;  // at most 0 when written
  const auto bits = static_cast<int>(std::bit_width(multiple.half));
  const int length =
      static_cast<int>(side.symbol(lengths_, static_cast<unsigned>(bits - finer))) + finer;
  if (length < 0 || length > kMostBits) {
    side.fail();
    return 0;
  }
  if (length > 1) {
    const std::uint64_t top = std::uint64_t{1} << (length - 1);
    multiple.half = top | side.raw(length - 1, multiple.half & (top - 1));
  } else {
    multiple.half = static_cast<std::uint64_t>(length);
  }
  return number_of(multiple, line);
}

template double Noise::code(Writing&, const NumberLine&, double);
template double Noise::code(Reading&, const NumberLine&, double);
template double Noise::code(FastWriting&, const NumberLine&, double);
template double Noise::code(FastReading&, const NumberLine&, double);

}  // namespace mocapress::exact
