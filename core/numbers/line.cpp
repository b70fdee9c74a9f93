#include "numbers/line.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "numbers/arithmetic.hpp"
#include "numbers/powers.hpp"

namespace mocapress {
namespace {

constexpr int kMostSignificant = 15;  // every number of 15 digits has a double of its own
constexpr int kMostExponent = 300;
constexpr std::int64_t kInfinity = 0x7f800000;  // its bits
constexpr std::int64_t kFarthest = std::int64_t{1} << 62;

// Every bit pattern in the order of the numbers, -0 before 0.
template <class Integer, class Bits>
std::int64_t ordered(Bits bits) {
  const auto number = static_cast<Integer>(bits);
  constexpr auto kLowest = std::numeric_limits<Integer>::min();
  return number >= 0 ? number : static_cast<Integer>(-1 - (number - kLowest));
}

template <class Integer, class Bits>
Bits unordered(std::int64_t place) {
  constexpr auto kLowest = std::numeric_limits<Integer>::min();
  const auto number = static_cast<Integer>(place);
  return static_cast<Bits>(number >= 0 ? number : static_cast<Integer>(kLowest + (-1 - number)));
}

std::int64_t place32(float number) {
  return ordered<std::int32_t>(std::bit_cast<std::uint32_t>(number));
}

float number32(std::int64_t place) {
  return std::bit_cast<float>(unordered<std::int32_t, std::uint32_t>(place));
}

// The number whose text, of the fewest digits that name a float, is this float's.
double shortest(float number) {
  std::array<char, 64> text{};
  const auto printed =
      std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::scientific);
  double found = number;
  std::from_chars(text.data(), printed.ptr, found);
  return found;
}

// The digits, as a whole number, that a magnitude has down to so many decimals, which may be fewer
// than none.
std::int64_t digits_of(double magnitude, int decimals) {
  double scaled = 0;
  if (decimals > kHighestPower) {
    scaled = (magnitude * power_of_ten(kHighestPower)) * power_of_ten(decimals - kHighestPower);
  } else if (decimals >= 0) {
    scaled = magnitude * power_of_ten(decimals);
  } else {
    scaled = magnitude / power_of_ten(-decimals);
  }
  return static_cast<std::int64_t>(rounded(scaled));
}

// The double nearest to digits / 10^decimals.
double number_of(std::int64_t digits, int decimals) {
  const auto number = static_cast<double>(digits);
  if (decimals >= 0 && decimals <= kMostExactPower) return number / power_of_ten(decimals);
  if (decimals < 0 && decimals >= -kMostExactPower) return number * power_of_ten(-decimals);
  // Such a power of ten is not exact; text is.
  std::array<char, 40> text{};
  char* const last = text.data() + text.size();
  char* end = std::to_chars(text.data(), last - 8, digits).ptr;
  *end++ = 'e';
  end = std::to_chars(end, last, -decimals).ptr;
  double exact = 0;
  std::from_chars(text.data(), end, exact);
  return exact;
}

// Out of the range of a float is undefined as a conversion, and on no float32 line.
float narrowed(double number) {
  constexpr double kMost = std::numeric_limits<float>::max();
  if (number > kMost) return std::numeric_limits<float>::infinity();
  if (number < -kMost) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(number);
}

}  // namespace

bool line_exists(int line, int digits) {
  switch (static_cast<Line>(line)) {
    case Line::float64:
    case Line::float32:
    case Line::shortest32:
      return true;
    case Line::significant:
      return digits >= 1 && digits <= kMostSignificant;
    case Line::decimals:
    case Line::printed32:
    case Line::degrees32:
      return digits >= 0 && digits <= kMostExactPower;
  }
  return false;
}

NumberLine::NumberLine(Line line, int digits) : line_(line), digits_(digits) {
  if (line == Line::significant) per_decade_ = 9 * integer_power(10, digits - 1);
  if (line == Line::decimals || printed()) scale_ = power_of_ten(digits);
  step_ = 1 / scale_;
  if (!printed()) return;
  if (line == Line::degrees32) unit_ = kDegreesPerRadian;
  float coarse = 0x1p-126f;
  while (coarse * 0x1p-23 * unit_ * scale_ <= 1) coarse *= 2;
  coarse_bits_ = std::bit_cast<std::int32_t>(coarse);
  coarse_place_ = decimal_place(coarse * unit_);
}

std::int64_t NumberLine::decimal_place(double magnitude) const {
  const double scaled = magnitude * scale_;
  return scaled < kRoundable ? static_cast<std::int64_t>(rounded(scaled)) : kFarthest;  // NaN, too
}

// As decimals count, and from the first coarse float on as floats do.
std::int64_t NumberLine::printed_place(double magnitude) const {
  const std::int64_t place = decimal_place(magnitude);
  if (place < coarse_place_) return place;
  const float number = narrowed(magnitude / unit_);
  const std::int64_t bits = std::bit_cast<std::int32_t>(number);
  return coarse_place_ + std::clamp(bits, coarse_bits_, kInfinity) - coarse_bits_;
}

double NumberLine::printed_number(std::int64_t place) const {
  if (place < coarse_place_) return static_cast<double>(place) / scale_;
  const auto bits = std::min(place - coarse_place_, kInfinity - coarse_bits_) + coarse_bits_;
  const double number = std::bit_cast<float>(static_cast<std::int32_t>(bits));
  return rounded(number * unit_ * scale_) / scale_;
}

std::int64_t NumberLine::decade(int exponent) const {
  return std::int64_t{exponent - kLowestPower} * per_decade_ + 1;
}

void NumberLine::turn_to(double magnitude) const {
  constexpr int kFarthest = 20;
  const int exponent = decimal_exponent(magnitude);
  const int decimals = digits_ - 1 - exponent;
  last_ = Decade();
  if (exponent < -kFarthest || decimals < 0 || decimals > kMostExactPower) return;
  last_.low = power_of_ten(exponent);
  last_.high = power_of_ten(exponent + 1);
  last_.scale = power_of_ten(decimals);
  last_.step = power_of_ten(-decimals);
  last_.first = decade(exponent);
  last_.base = last_.first - per_decade_ / 9;
}

// On the line of significant digits: 0, then decade by decade d.ddd x 10^exponent.
std::int64_t NumberLine::magnitude_place(double magnitude) const {
  if (last_.holds(magnitude)) {
    return last_.base + static_cast<std::int64_t>(rounded(magnitude * last_.scale));
  }
  if (line_ == Line::decimals) return decimal_place(magnitude);
  if (printed()) return printed_place(magnitude);
  if (magnitude < power_of_ten(kLowestPower)) return 0;  // denormals are off this line
  if (!(magnitude < power_of_ten(kMostExponent))) return decade(kMostExponent);
  turn_to(magnitude);
  const int exponent = decimal_exponent(magnitude);
  return decade(exponent) + digits_of(magnitude, digits_ - 1 - exponent) - per_decade_ / 9;
}

double NumberLine::magnitude_number(std::int64_t place) const {
  if (line_ == Line::decimals) return static_cast<double>(place) / scale_;
  if (printed()) return printed_number(place);
  if (place == 0) return 0;
  if (place >= last_.first && place < last_.first + per_decade_ && last_.scale > 0) {
    return static_cast<double>(place - last_.base) / last_.scale;
  }
  const std::int64_t exponent = (place - 1) / per_decade_ + kLowestPower;
  if (exponent > kHighestPower) return std::numeric_limits<double>::infinity();
  const std::int64_t digits = (place - 1) % per_decade_ + per_decade_ / 9;
  return number_of(digits, digits_ - 1 - static_cast<int>(exponent));
}

std::int64_t NumberLine::place(double number) const {
  switch (line_) {
    case Line::float64:
      return ordered<std::int64_t>(std::bit_cast<std::uint64_t>(number));
    case Line::float32:
    case Line::shortest32:
      return place32(narrowed(number));
    default: {
      const std::int64_t place = magnitude_place(std::fabs(number));
      return std::signbit(number) ? -1 - place : place;
    }
  }
}

double NumberLine::number(std::int64_t place) const {
  switch (line_) {
    case Line::float64:
      return std::bit_cast<double>(unordered<std::int64_t, std::uint64_t>(place));
    case Line::float32:
      return number32(place);
    case Line::shortest32:
      return shortest(number32(place));
    default:
      return place >= 0 ? magnitude_number(place) : -magnitude_number(-1 - place);
  }
}

std::int64_t NumberLine::near(double number) const {
  switch (line_) {
    case Line::float64:
    case Line::float32:
    case Line::shortest32:
      return place(number + 0.0);  // not -0
    default:
      return number > 0 ? magnitude_place(number) : -1 - magnitude_place(-number);
  }
}

double NumberLine::nearest(double number) const {
  if (number == 0 || !std::isfinite(number)) return number;
  const double magnitude = std::fabs(number);
  switch (line_) {
    case Line::float64:
      return number;
    case Line::float32:
      return narrowed(number);
    case Line::shortest32:
      return shortest(narrowed(number));
    case Line::significant: {
      if (!(magnitude >= power_of_ten(kLowestPower) && magnitude < power_of_ten(kMostExponent))) {
        return number;
      }
      const int decimals = digits_ - 1 - decimal_exponent(magnitude);
      return std::copysign(number_of(digits_of(magnitude, decimals), decimals), number);
    }
    default: {
      const std::int64_t place = magnitude_place(magnitude);
      return place == kFarthest ? number : std::copysign(magnitude_number(place), number);
    }
  }
}

double NumberLine::step(double value) const {
  const double magnitude = std::fabs(value);
  switch (line_) {
    case Line::float64:
      return magnitude * 0x1p-52;
    case Line::float32:
    case Line::shortest32:
      return magnitude * 0x1p-23;
    case Line::decimals:
      return step_;
    case Line::printed32:
    case Line::degrees32:
      return std::max(step_, magnitude * 0x1p-23);
    default: {
      if (last_.holds(magnitude)) return last_.step;
      if (!(magnitude >= 1e-290)) return 1e-300;
      const int exponent = decimal_exponent(magnitude) - digits_ + 1;
      return power_of_ten(exponent);
    }
  }
}

}  // namespace mocapress
