// APP's floating-point compression: how an actual value is coded beside its prediction (Section 4).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "coding/numbers.hpp"

namespace mocapress::app {

template <class Float>
struct Layout;
template <>
struct Layout<float> {
  using Bits = std::uint32_t;
  static constexpr int kMantissaBits = 23;
  static constexpr int kExponentBits = 8;
  static constexpr int kLengthBits = 5;
};
template <>
struct Layout<double> {
  using Bits = std::uint64_t;
  static constexpr int kMantissaBits = 52;
  static constexpr int kExponentBits = 11;
  static constexpr int kLengthBits = 6;
};

// Step 1 of Algorithm 1.
template <class Float>
struct Parts {
  bool sign;
  int exponent;
  std::int64_t mantissa;

  static Parts split(Float value) {
    using L = Layout<Float>;
    const auto bits = std::bit_cast<typename L::Bits>(value);
    return {(bits >> (L::kMantissaBits + L::kExponentBits)) != 0,
            static_cast<int>(bits >> L::kMantissaBits & ((1 << L::kExponentBits) - 1)),
            static_cast<std::int64_t>(bits & ((typename L::Bits{1} << L::kMantissaBits) - 1))};
  }

  Float join() const {
    using L = Layout<Float>;
    using Bits = typename L::Bits;
    return std::bit_cast<Float>(static_cast<Bits>(
        Bits{sign} << (L::kMantissaBits + L::kExponentBits) |
        static_cast<Bits>(exponent) << L::kMantissaBits | static_cast<Bits>(mantissa)));
  }
};

// Algorithm 1, with its contexts expo_diff and MTS[Exp].
template <class Float>
class Correction {
  using L = Layout<Float>;

 public:
  explicit Correction(int mantissa_limit)
      : limit_(mantissa_limit), mantissas_(std::size_t{1} << L::kExponentBits) {}

  template <class Side>
  Float code(Side& side, Float actual, Float predicted) {
    auto value = Parts<Float>::split(actual);
    const auto p = Parts<Float>::split(predicted);
    const int difference = value.exponent - p.exponent;
    const bool far = value.sign != p.sign || std::abs(difference) > kFarthest;
    if (!side.bit(moved_, far || difference != 0)) {
      Mantissa& context = mantissas_[static_cast<std::size_t>(p.exponent)];
      const std::int64_t correction = value.mantissa - p.mantissa;
      const auto width = std::bit_width(static_cast<std::uint64_t>(std::abs(correction)));
      const bool escape = static_cast<int>(width) >= limit_;
      value.sign = p.sign;
      value.exponent = p.exponent;
      if (!can_escape() || !side.bit(context.escape, escape)) {  // step 4
        const auto coded = static_cast<std::uint64_t>(context.difference.code(side, correction));
        value.mantissa = static_cast<std::int64_t>(static_cast<std::uint64_t>(p.mantissa) + coded);
        if (value.mantissa >> L::kMantissaBits != 0) sound_ = false;
        return value.join();
      }
    } else {
      const unsigned symbol =
          expo_diff_.code(side, far ? kFar : static_cast<unsigned>(difference + kFarthest));
      if (symbol < kFar) {
        value.sign = p.sign;
        value.exponent = p.exponent + static_cast<int>(symbol) - kFarthest;
        if (value.exponent >> L::kExponentBits != 0) sound_ = false;
      } else {  // step 3
        value.sign = side.raw(1, value.sign ? 1 : 0) != 0;
        value.exponent = static_cast<int>(
            side.raw(L::kExponentBits, static_cast<std::uint64_t>(value.exponent)));
      }
    }
    value.mantissa = static_cast<std::int64_t>(  // step 5
        side.raw(L::kMantissaBits, static_cast<std::uint64_t>(value.mantissa)));
    return value.join();
  }

  // Whether no decoded exponent or mantissa left its range.
  bool sound() const { return sound_; }

 private:
  static constexpr int kFarthest = 3;                  // largest |Exp_a - Exp_p| of step 2
  static constexpr unsigned kFar = 2 * kFarthest + 1;  // leads to step 3

  struct Mantissa {
    Bit escape;
    Difference<L::kLengthBits> difference;
  };

  bool can_escape() const { return limit_ <= L::kMantissaBits; }

  int limit_;
  bool sound_ = true;
  Bit moved_;  // expo_diff's first question: is the difference other than 0?
  BitTree<3> expo_diff_;
  std::vector<Mantissa> mantissas_;
};

}  // namespace mocapress::app
