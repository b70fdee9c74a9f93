#include "numbers/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "numbers/powers.hpp"

namespace mocapress {
namespace {

// 10^count, for count <= 19.
std::uint64_t whole_power(unsigned count) {
  static constexpr auto kPowers = [] {
    std::array<std::uint64_t, 20> powers{1};
    for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = 10 * powers[i - 1];
    return powers;
  }();
  return kPowers[count];
}

// Value of a text of digits with at most one exponent that the fast path cannot give.
const char* parse_slow(const char* text, const char* end, bool negative, std::int64_t exponent10,
                       double& value) {
  const auto [rest, error] = std::from_chars(text, end, value);
  if (error == std::errc::result_out_of_range) {
    if (exponent10 > 0) return nullptr;
    value = 0.0;
  } else if (error != std::errc{} || rest != end) {
    return nullptr;
  }
  if (negative) value = -value;
  return end;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

char* print_digits(char* out, std::uint64_t number, unsigned count) {
  for (char* place = out + count; place > out; number /= 10)
    *--place = static_cast<char>('0' + number % 10);
  return out + count;
}

unsigned count_digits(std::uint64_t number) {
  unsigned count = 1;
  while (number >= 10) number /= 10, ++count;
  return count;
}

char* print_exponent(char* out, int exponent, const NumberFormat& format) {
  *out++ = format.upper ? 'E' : 'e';
  if (exponent < 0 || !format.java) *out++ = exponent < 0 ? '-' : '+';
  const auto magnitude = static_cast<std::uint64_t>(std::abs(exponent));
  return print_digits(out, magnitude,
                      std::max<unsigned>(count_digits(magnitude), format.exponent_digits));
}

// A decimal number: 0.d1d2d3... x 10^(exponent+1), its digits in `digits`.
struct Decimal {
  std::uint64_t digits;
  unsigned count;
  int exponent;
};

// What follows a whole number.
char* print_whole_end(char* out, const NumberFormat& format) {
  if (format.point_zero || format.end_point) *out++ = '.';
  if (format.point_zero) *out++ = '0';
  return out;
}

// Lays out significant digits (no trailing zeros) as C's %g does, with the switch to an exponent
// below 1e-4 and from 10^limit on, or where Java and JavaScript have it.
char* print_decimal(char* out, Decimal number, int limit, const NumberFormat& format) {
  char digits[24];
  print_digits(digits, number.digits, number.count);
  const auto count = static_cast<int>(number.count);
  const int exponent = number.exponent;
  const int least = format.java ? -3 : format.javascript ? -6 : -4;
  if (exponent < least || exponent >= (format.java ? 7 : format.javascript ? 21 : limit)) {
    *out++ = digits[0];
    if (count > 1 || format.java) *out++ = '.';
    if (count > 1) out = std::copy(digits + 1, digits + count, out);
    if (count == 1 && format.java) *out++ = '0';
    return print_exponent(out, exponent, format);
  }
  if (exponent < 0) {
    if (!format.bare_point) *out++ = '0';
    *out++ = '.';
    out = std::fill_n(out, -exponent - 1, '0');
    return std::copy(digits, digits + count, out);
  }
  const int whole = exponent + 1;
  if (count <= whole) {
    out = std::copy(digits, digits + count, out);
    out = std::fill_n(out, whole - count, '0');
    return print_whole_end(out, format);
  }
  out = std::copy(digits, digits + whole, out);
  *out++ = '.';
  return std::copy(digits + whole, digits + count, out);
}

Decimal strip_zeros(std::uint64_t digits, unsigned count, int exponent) {
  while (count > 1 && digits % 10 == 0) digits /= 10, --count;
  return {digits, count, exponent};
}

// Reads back what std::to_chars printed in scientific notation.
Decimal read_scientific(const char* text, const char* end) {
  std::uint64_t digits = 0;
  unsigned count = 0;
  for (; text < end && *text != 'e'; ++text)
    if (*text != '.') digits = digits * 10 + static_cast<std::uint64_t>(*text - '0'), ++count;
  int exponent = 0;
  std::from_chars(text + (text[1] == '+' ? 2 : 1), end, exponent);
  return {digits, count, exponent};
}

// Significant digits of a positive value, rounded to `count` of them.
Decimal round_significant(double value, unsigned count) {
  if (count <= 15 && value >= 1e-7 && value < 1e22) {
    int exponent = decimal_exponent(value);
    const int shift = static_cast<int>(count) - 1 - exponent;
    const double scaled = shift >= 0 ? value * power_of_ten(shift) : value / power_of_ten(-shift);
    auto digits = static_cast<std::uint64_t>(std::llrint(scaled));
    if (digits >= whole_power(count)) digits /= 10, ++exponent;
    if (digits >= whole_power(count - 1)) return strip_zeros(digits, count, exponent);
  }
  char text[64];
  const auto result = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific,
                                    static_cast<int>(count) - 1);
  const Decimal number = read_scientific(text, result.ptr);
  return strip_zeros(number.digits, number.count, number.exponent);
}

char* print_fixed(char* out, double value, const NumberFormat& format) {
  const unsigned decimals = format.digits;
  char* const start = out;
  if (decimals <= 15 && value * power_of_ten(static_cast<int>(decimals)) < 1e15) {
    const auto scaled =
        static_cast<std::uint64_t>(std::llrint(value * power_of_ten(static_cast<int>(decimals))));
    const std::uint64_t whole = scaled / whole_power(decimals);
    if (whole > 0 || !format.bare_point || decimals == 0)
      out = print_digits(out, whole, count_digits(whole));
    if (decimals > 0) {
      *out++ = '.';
      out = print_digits(out, scaled % whole_power(decimals), decimals);
    }
  } else {
    const auto result = std::to_chars(out, out + kLongestNumber - 1, value,
                                      std::chars_format::fixed, static_cast<int>(decimals));
    out = result.ptr;
    if (format.bare_point && *start == '0' && decimals > 0) {
      std::memmove(start, start + 1, static_cast<std::size_t>(out - start - 1));
      --out;
    }
  }
  if (format.kind == NumberKind::trimmed && decimals > 0) {
    while (out[-1] == '0') --out;
    if (out[-1] == '.') {
      if (--out == start && !format.point_zero) *out++ = '0';
      out = print_whole_end(out, format);
    }
  }
  if (decimals == 0 && format.end_point) *out++ = '.';
  return out;
}

char* print_scientific(char* out, double value, const NumberFormat& format) {
  char* const start = out;
  out = std::to_chars(out, out + kLongestNumber - 1, value, std::chars_format::scientific,
                      format.digits)
            .ptr;
  char* mark = std::find(start, out, 'e');
  int exponent = 0;
  std::from_chars(mark + (mark[1] == '+' ? 2 : 1), out, exponent);
  return print_exponent(mark, exponent, format);
}

}  // namespace

const char* parse_number(const char* text, const char* end, double& value, NumberShape& shape) {
  const char* p = text;
  shape = {};
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  const char* const start = p;
  shape.plus = p > text && !negative;
  shape.leading_zero = end - p > 1 && p[0] == '0' && is_digit(p[1]);
  std::uint64_t digits = 0;
  while (p < end && is_digit(*p)) digits = digits * 10 + static_cast<std::uint64_t>(*p++ - '0');
  const auto whole = p - start;
  std::ptrdiff_t decimals = 0;
  if (p < end && *p == '.') {
    const char* const point = ++p;
    while (p < end && is_digit(*p)) digits = digits * 10 + static_cast<std::uint64_t>(*p++ - '0');
    decimals = p - point;
    shape.point = true;
    shape.bare_point = whole == 0;
    shape.end_point = decimals == 0;
    shape.trailing_zero = decimals > 0 && p[-1] == '0';
  }
  if (whole + decimals == 0) return nullptr;
  std::int64_t exponent = 0;
  if (p < end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    const bool down = q < end && *q == '-';
    if (q < end && (*q == '-' || *q == '+')) ++q;
    const char* const first = q;
    while (q < end && is_digit(*q))
      exponent = std::min<std::int64_t>(exponent * 10 + (*q++ - '0'), 1'000'000);
    if (q == first) return nullptr;
    shape.upper = *p == 'E';
    shape.exponent_digits = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(q - first, 255));
    if (down) exponent = -exponent;
    p = q;
  }
  shape.decimals = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(decimals, 255));
  const std::int64_t shift = exponent - decimals;
  if (whole + decimals <= 19 && digits < (std::uint64_t{1} << 53) && shift >= -kMostExactPower &&
      shift <= kMostExactPower) {
    shape.significant = digits == 0 ? 0 : static_cast<std::uint8_t>(count_digits(digits));
    value = static_cast<double>(digits);
    const double power = power_of_ten(static_cast<int>(shift < 0 ? -shift : shift));
    value = shift < 0 ? value / power : value * power;
    if (negative) value = -value;
    return p;
  }
  const char* first = start;
  while (first < p && (*first == '0' || *first == '.')) ++first;
  std::ptrdiff_t significant = 0;
  for (const char* q = first; q < p && (is_digit(*q) || *q == '.'); ++q) significant += *q != '.';
  shape.significant = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(significant, 255));
  // Decimal exponent of the leading digit: tells overflow from underflow.
  return parse_slow(start, p, negative, shift + significant, value);
}

const char* parse_non_finite(const char* text, const char* end, double& value, NumberShape& shape) {
  const bool negative = text < end && *text == '-';
  if (text < end && (*text == '-' || *text == '+')) ++text;
  const auto begins = [&](const char* word) {
    const char* p = text;
    while (*word != 0 && p != end && (*p | (is_letter(*p) ? 0x20 : 0)) == *word) ++p, ++word;
    return *word == 0 ? p : nullptr;
  };
  bool infinite = false;
  const char* rest = nullptr;
  for (const char* const word : {"1.#inf", "infinity", "inf"}) {
    rest = begins(word);
    infinite = rest != nullptr;
    if (infinite) break;
  }
  for (const char* const word : {"1.#ind", "1.#qnan", "1.#snan", "1.#j", "nan"}) {
    if (rest != nullptr) break;
    rest = begins(word);
  }
  if (rest == nullptr) return nullptr;
  if (text < end && *text == '1') {
    while (rest < end && is_digit(*rest)) ++rest;
  } else if (!infinite && rest < end && *rest == '(') {
    while (rest < end && *rest != ')' && *rest > ' ') ++rest;
    if (rest == end || *rest != ')') return nullptr;
    ++rest;
  }
  shape = {};
  shape.word = true;
  using Limits = std::numeric_limits<double>;
  value = std::copysign(infinite ? Limits::infinity() : Limits::quiet_NaN(), negative ? -1.0 : 1.0);
  return rest;
}

char* print_number(char* out, double value, const NumberFormat& format) {
  if (std::signbit(value)) {
    *out++ = '-', value = -value;
  } else if (format.plus) {
    *out++ = '+';
  }
  if (!std::isfinite(value)) {
    const char* const name = std::isnan(value) ? "nan" : "inf";
    return std::copy(name, name + 3, out);
  }
  switch (format.kind) {
    case NumberKind::fixed:
    case NumberKind::trimmed:
      return print_fixed(out, value, format);
    case NumberKind::scientific:
      return print_scientific(out, value, format);
    default:
      break;
  }
  if (value == 0) {
    *out++ = '0';
    return print_whole_end(out, format);
  }
  if (format.kind == NumberKind::general)
    return print_decimal(out, round_significant(value, format.digits), format.digits, format);
  char text[64];
  const auto result =
      format.kind == NumberKind::shortest32
          ? std::to_chars(text, text + sizeof text, static_cast<float>(value),
                          std::chars_format::scientific)
          : std::to_chars(text, text + sizeof text, value, std::chars_format::scientific);
  if (*text == 'i') return std::copy(text, result.ptr, out);  // beyond the range of a float32
  return print_decimal(out, read_scientific(text, result.ptr), 16, format);
}

}  // namespace mocapress
