#include "exact_fast/ruler.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mocapress::exact {
namespace {

constexpr int kMostBinary = 900;     // so that steps are normal numbers
constexpr int kMostDecadesUp = 9;    // above the one taken
constexpr double kFarthest = 1e300;  // levels

}  // namespace

Ruler::Ruler(const Column& column)
    : line_(column.line, column.digits),
      kind_(column.line),
      unit_(std::ldexp(1.0, column.exponent)) {
  switch (kind_) {
    case Line::decimals:
      power_ = power_of_ten(column.digits);
      step_ = unit_ / power_;
      low_ = -1;
      high_ = std::numeric_limits<double>::infinity();
      first_ = 1;
      break;
    case Line::printed32:
    case Line::degrees32:
      break;
    case Line::significant:
      digits_ = column.digits;
      lowest_ = kLowestPower;
      origin_ = 1;
      first_ = integer_power(10, digits_ - 1);
      per_decade_ = 9 * first_;
      least_ = digits_ - 1 - kMostExactPower;
      most_ = digits_ - 1 + kMostExactPower;
      break;
    default:
      digits_ = kind_ == Line::float64 ? 53 : 24;
      base_ = 2;
      most_bits_ = 61;  // marks of higher decades end in zeros
      lowest_ = kind_ == Line::float64 ? -1023 : -127;
      first_ = integer_power(2, digits_ - 1);
      per_decade_ = first_;
      least_ = kind_ == Line::float64 ? -kMostBinary : lowest_ + 1;
      most_ = kind_ == Line::float64 ? kMostBinary : -lowest_;
  }
  whole_ = static_cast<std::uint64_t>(first_);
  // Their numbers are not marks times a power: none is whole.
  if (kind_ == Line::shortest32 || printed()) whole_ = std::numeric_limits<std::uint64_t>::max();
  move(0);
}

void Ruler::move(double magnitude) {
  const double number = std::min(magnitude / unit_, kFarthest);
  if (printed()) {
    step_ = line_.step(number) * unit_;
  } else if (kind_ != Line::decimals) {
    if (base_ == 10) {
      decade_ = number >= 1e-300 ? decimal_exponent(number) : least_;
    } else {
      const auto bits = std::bit_cast<std::uint64_t>(number >= 1e-300 ? number : 1e-300);
      decade_ = static_cast<int>(bits >> 52) - 1023;
    }
    decade_ = std::clamp(decade_, least_, most_);
    const int last = decade_ - digits_ + 1;  // the step is base^last
    const auto power = [this](int exponent) {
      return base_ == 10 ? power_of_ten(exponent) : power_of_two(exponent);
    };
    low_ = decade_ == least_ ? -1 : power(decade_) * unit_;
    high_ = decade_ == most_ ? std::numeric_limits<double>::infinity() : power(decade_ + 1) * unit_;
    divided_ = base_ == 10 && last < 0;
    power_ = power(divided_ ? -last : last);
    step_ = divided_ ? unit_ / power_ : unit_ * power_;
  }
  step_ = std::max(step_, 1e-300);
  per_step_ = 1 / step_;
  log_step_ = octaves(step_);
}

std::int64_t Ruler::near_place(double predicted) const {
  const std::int64_t place = line_.near(std::fabs(predicted) / unit_);
  return place < 0 ? 0 : predicted < 0 ? -place : place;
}

Ruler::Place Ruler::place(double number) const {
  const std::int64_t signed_place = line_.place(number);
  if (!line_.holds(number, signed_place)) return {0, 0, false, false};
  const bool negative = signed_place < 0;
  const std::int64_t place = negative ? ~signed_place : signed_place;
  // Places beyond what decimals reach stand for one number alone.
  if (kind_ == Line::decimals && place >> most_bits_ != 0) return {0, 0, negative, false};
  std::int64_t marks = place;
  std::uint64_t rest = 0;
  if (kind_ != Line::decimals && !printed()) {
    if (place < origin_) return {0, 0, negative, true};
    const std::int64_t decade = (place - origin_) / per_decade_;
    const std::int64_t digits = (place - origin_) % per_decade_ + first_;
    const std::int64_t lower = decade_ - (decade + lowest_);
    if (decade + lowest_ > most_ || lower < -kMostDecadesUp) return {0, 0, negative, false};
    if (lower <= 0) {
      const std::int64_t times = integer_power(base_, static_cast<int>(-lower));
      if (digits > (std::int64_t{1} << 62) / times) return {0, 0, negative, false};
      marks = digits * times;
      if (marks >> most_bits_ != 0) return {0, 0, negative, false};
    } else if (lower < digits_) {
      const std::int64_t times = integer_power(base_, static_cast<int>(lower));
      marks = digits / times;
      rest = static_cast<std::uint64_t>(digits % times);
    } else {
      marks = 0;
      rest = static_cast<std::uint64_t>(place);
    }
  }
  return {negative ? -marks : marks, rest, negative, true};
}

// Off the beaten track: numbers with a rest, and what a damaged stream says.
template <class Side>
double Ruler::finish_rest(Side& side, const Place& place, double& level) {
  bool negative = place.steps < 0;
  auto marks = static_cast<std::int64_t>(magnitude(place.steps));
  std::int64_t at = marks;
  if (marks >> most_bits_ != 0) {
    side.fail();
  } else if (marks == 0) {
    negative = side.bit(negative_, place.negative);
    if (side.bit(nonzero_, place.rest != 0)) {
      const auto bits = static_cast<std::uint32_t>(std::bit_width(place.rest));
      const auto length = static_cast<int>(side.uniform(64, bits));
      at = static_cast<std::int64_t>(side.raw(length, place.rest));
    }
  } else if (!printed()) {
    int decade = decade_;
    std::int64_t below = 1;
    for (; marks < first_; marks *= base_) {
      --decade;
      below *= base_;
    }
    std::int64_t rest = 0;
    auto left = static_cast<std::int64_t>(place.rest);
    for (std::int64_t part = below; part > 1;) {
      const std::int64_t unit = std::min<std::int64_t>(part, base_ == 10 ? 1000 : 1 << 10);
      part /= unit;
      const auto digit = static_cast<std::int64_t>(
          side.uniform(static_cast<std::uint64_t>(unit), static_cast<std::uint64_t>(left / part)));
      left %= part;
      rest += digit * part;
    }
    marks += rest;
    for (; marks >= first_ * base_; marks /= base_) ++decade;
    at = origin_ + (decade - lowest_) * per_decade_ + marks - first_;
  }
  const double number = line_.number(negative ? ~at : at);
  level = this->level(number);
  return number;
}

template double Ruler::finish_rest(RansWriting&, const Place&, double&);
template double Ruler::finish_rest(RansReading&, const Place&, double&);

}  // namespace mocapress::exact
