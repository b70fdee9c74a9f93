#include "exact/noise.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "coding/sides.hpp"
#include "numbers/arithmetic.hpp"

namespace mocapress::exact {
namespace {

constexpr int kLowest = -12;  // the smallest q
constexpr unsigned kZero = 62;
constexpr unsigned kOther = 63;
constexpr int kMostBits = 20;  // of k
constexpr double kMostMultiple = 1e6;
constexpr int kLongest = 40;  // the finest kind: lengths count from what it would have

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
  const double degrees = line.number(line.place(radians * kDegreesPerRadian));
  return multiple.negative ? -degrees : degrees;
}

Multiple multiple_of(double number, const NumberLine& line) {
  const bool negative = std::signbit(number);
  if (number == 0) return {kZero, negative, 0};
  const double radians = std::fabs(number) / kDegreesPerRadian;
  for (unsigned kind = 0; kind <= kLongest; ++kind) {
    const double times = radians * power_of_two(58 + kLowest + static_cast<int>(kind));
    if (!(times <= kMostMultiple)) break;  // NaN, too
    const auto whole = static_cast<std::uint64_t>(times + 0.5);
    const Multiple multiple{kind, negative, whole / 2};
    if (whole % 2 == 1 && number_of(multiple, line) == number) return multiple;
  }
  return {kOther, negative, 0};
}

}  // namespace

NoiseColumns::NoiseColumns(std::span<const Column> columns) {
  const auto found =
      std::ranges::find_if(columns, [](const Column& column) { return column.noise; });
  first_ = static_cast<std::size_t>(found - columns.begin());
  for (const Column& column : columns.subspan(first_)) {
    columns_.push_back({NumberLine(column.line, column.digits), Noise()});
  }
}

template <class Side>
double Noise::code(Side& side, const NumberLine& line, double number) {
  Multiple multiple{};
  if constexpr (!Side::kReading) multiple = multiple_of(number, line);
  multiple.kind = kinds_.code(side, multiple.kind);
  if (multiple.kind == kOther) {
    return std::bit_cast<double>(side.raw(64, std::bit_cast<std::uint64_t>(number)));
  }
  multiple.negative = side.raw(1, multiple.negative ? 1 : 0) != 0;
  if (multiple.kind == kZero) return number_of(multiple, line);
  // The numbers are of one size, whatever the unit: the finer it is, the longer is k.
  const int finer = static_cast<int>(multiple.kind) - kLongest;  // at most 0 when written
  const auto bits = static_cast<int>(std::bit_width(multiple.half));
  const int length =
      static_cast<int>(lengths_.code(side, static_cast<unsigned>(bits - finer))) + finer;
  if (length < 0 || length > kMostBits) {
    side.fail();
    return 0;
  }
  multiple.half = code_below_leading(side, length, multiple.half);
  return number_of(multiple, line);
}

template double Noise::code(RangeWriting&, const NumberLine&, double);
template double Noise::code(RangeReading&, const NumberLine&, double);
template double Noise::code(RansWriting&, const NumberLine&, double);
template double Noise::code(RansReading&, const NumberLine&, double);

}  // namespace mocapress::exact
