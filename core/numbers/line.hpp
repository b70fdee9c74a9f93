// The numbers that a column can hold, in order: each has a place, a whole number, so that a codec
// may code places around a prediction instead of the bits of a float.
#pragma once

#include <bit>
#include <cstdint>

#include "numbers/powers.hpp"

namespace mocapress {

// The kinds of mocapress.motion.NumberFormat, of which SCIENTIFIC is `significant` with one digit
// more; `float64` has a place for every bit pattern, and so for everything.
// `printed32` and `degrees32` are what is left of float32 numbers, and of float32 radians in
// degrees, when they are printed with so many decimals.
enum class Line : std::uint8_t {
  float64,
  float32,
  significant,
  decimals,
  shortest32,
  printed32,
  degrees32
};

class NumberLine {
 public:
  NumberLine(Line line, int digits);

  // The place of a number. Only where number(place(x)) has the bits of x is x on the line.
  std::int64_t place(double number) const;
  // Whether it is, `place` being its place.
  bool holds(double number, std::int64_t place) const {
    return std::bit_cast<std::uint64_t>(this->number(place)) ==
           std::bit_cast<std::uint64_t>(number);
  }
  double number(std::int64_t place) const;

  // A place next to any number but NaN, on the line or not. Never smaller for a larger number, and
  // the same on every machine: a coder needs no more.
  std::int64_t near(double number) const;

  // The number of the line nearest to one that rounding has moved away. Keeps -0, infinities, NaN
  // and what is further out than the line goes.
  double nearest(double number) const;

  // The distance between the numbers near `value`.
  double step(double value) const;

  bool significant() const { return line_ == Line::significant; }

  // The place where the numbers of the decade 10^exponent begin; only for `significant` lines.
  std::int64_t decade(int exponent) const;
  // The decade of a place > 0.
  int decade_of(std::int64_t place) const {
    return static_cast<int>((place - 1) / per_decade_) + kLowestPower;
  }

 private:
  // A decade of a line of significant digits, 10^e <= magnitude < 10^(e+1), that can be counted by
  // one multiplication: the next number most often lies in that of the last one.
  struct Decade {
    double low = 1;
    double high = 0;         // at first it holds nothing
    double scale = 0;        // from magnitudes to digits
    double step = 0;         // between its numbers
    std::int64_t base = 0;   // place of a number less its digits
    std::int64_t first = 0;  // place of the first number
    bool holds(double magnitude) const { return magnitude >= low && magnitude < high; }
  };

  // Makes `last_` the decade of a magnitude, where it can be counted so.
  void turn_to(double magnitude) const;

  std::int64_t magnitude_place(double magnitude) const;
  double magnitude_number(std::int64_t place) const;
  std::int64_t decimal_place(double magnitude) const;
  std::int64_t printed_place(double magnitude) const;
  double printed_number(std::int64_t place) const;
  bool printed() const { return line_ == Line::printed32 || line_ == Line::degrees32; }

  Line line_;
  int digits_;
  std::int64_t per_decade_ = 0;
  double scale_ = 1;
  double step_ = 1;
  // Of printed lines: degrees in a radian or 1, the bits of the first float that is further from
  // the next than decimals are, and its place.
  double unit_ = 1;
  std::int64_t coarse_bits_ = 0;
  std::int64_t coarse_place_ = 0;
  mutable Decade last_;
};

// Whether a line of this kind can have as many digits.
bool line_exists(int line, int digits);

}  // namespace mocapress
