// Numbers as text: parsing, and printing in the ways that motion files print.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mocapress {

enum class NumberKind : std::uint8_t {
  general = 0,
  fixed = 1,
  trimmed = 2,
  scientific = 3,
  shortest = 4,
  shortest32 = 5,
};

struct NumberFormat {
  NumberKind kind = NumberKind::shortest;
  std::uint8_t digits = 0;
  std::uint8_t exponent_digits = 2;
  bool point_zero = false;
  bool bare_point = false;
  bool upper = false;
  bool plus = false;        // a `+` before what is not negative
  bool zeros = false;       // what is padded, is padded with zeros
  bool end_point = false;   // a whole number ends in a point
  bool java = false;        // an exponent below 1e-3 and from 1e7 on, as in 1.0E-5
  bool javascript = false;  // an exponent below 1e-6 and from 1e21 on, as in 1e-7

  bool operator==(const NumberFormat&) const = default;
};

inline constexpr unsigned kMostDigits = 40;
// Longest text of any double in any format: sign, 309 digits, point, kMostDigits decimals.
inline constexpr std::size_t kLongestNumber = 384;

// How a number was written, as far as it tells which format printed it.
struct NumberShape {
  std::uint8_t decimals = 0;         // digits behind the point
  std::uint8_t significant = 0;      // digits from the first that is not zero
  std::uint8_t exponent_digits = 0;  // 0: no exponent
  bool point = false;
  bool trailing_zero = false;  // the last decimal is 0
  bool bare_point = false;
  bool upper = false;
  bool plus = false;
  bool leading_zero = false;  // more zeros than one before the point, or before other digits
  bool end_point = false;     // a point that nothing follows
  bool word = false;          // no number: `nan`, `inf` and the like
};

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Parses a finite decimal number at `text`; gives the end of it, or nullptr where there is none or
// where it exceeds the range of a double. The value is the nearest double, as strtod gives it.
const char* parse_number(const char* text, const char* end, double& value, NumberShape& shape);

// Parses a word that stands for no number, as C libraries print them: `nan`, `-nan(ind)`, `inf`,
// `Infinity`, `1.#QNAN0`, `-1.#IND00`, `1.#INF`, in any case; gives the end of it, or nullptr.
const char* parse_non_finite(const char* text, const char* end, double& value, NumberShape& shape);

// Prints a value; gives the end of the text. `out` has room for kLongestNumber bytes.
char* print_number(char* out, double value, const NumberFormat& format);

}  // namespace mocapress
