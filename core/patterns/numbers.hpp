// Whole numbers of a size that is foretold, coded by either side of coding/sides.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "coding/bit.hpp"

namespace mocapress::patterns {

// A bit whose chance of being 0 is counted; at first as if one bit had been seen.
class Tally {
 public:
  template <class Side>
  bool code(Side& side, bool one) {
    const std::uint32_t chance = (zeros_ << 16) / all_;
    const bool coded = side.chance(std::clamp<std::uint32_t>(chance, 64, 65472), one);
    zeros_ += coded ? 0 : kOne;
    all_ += kOne;
    if (all_ > kOne * 256) {
      zeros_ /= 2;
      all_ /= 2;
    }
    return coded;
  }

 private:
  static constexpr std::uint32_t kOne = 32;
  std::uint32_t zeros_ = kOne / 2, all_ = kOne;
};

// How large the numbers of a series were of late: 16 times a mean of their magnitudes.
class Usual {
 public:
  explicit Usual(std::uint32_t at_first = 16) : mean_(static_cast<std::int32_t>(at_first)) {}

  std::size_t bucket() const {
    return static_cast<std::size_t>(std::bit_width(static_cast<std::uint32_t>(mean_)));
  }
  void see(std::uint64_t magnitude) {
    const auto seen = static_cast<std::int32_t>(std::min<std::uint64_t>(magnitude, 4095)) * 16;
    mean_ += (seen - mean_) >> 2;
  }

 private:
  std::int32_t mean_;  // below 2^16
};

inline constexpr int kMostBits = 52;  // of a magnitude
inline constexpr std::int64_t kMostNumber = (std::int64_t{1} << kMostBits) - 1;

// Numbers of one kind: what is learned of their bits is shared by all series of it.
class Numbers {
 public:
  // 0 <= value <= kMostNumber
  template <class Side>
  std::uint64_t count(Side& side, Usual& usual, std::uint64_t value) {
    Context& context = contexts_[usual.bucket()];
    const auto width = static_cast<int>(std::bit_width(value));
    int length = 0;
    while (length < kMostBits && context.longer[length].code(side, width > length)) ++length;
    std::uint64_t coded = static_cast<std::uint64_t>(length);
    if (length > 1) {
      const int below = length - 2;
      const bool second = context.second[length].code(side, (value >> below & 1) != 0);
      const std::uint64_t mask = (std::uint64_t{1} << below) - 1;
      coded = (std::uint64_t{second ? 3u : 2u} << below) | side.raw(below, value & mask);
    }
    usual.see(coded);
    return coded;
  }

  // -kMostNumber <= value <= kMostNumber
  template <class Side>
  std::int64_t number(Side& side, Usual& usual, std::int64_t value) {
    const auto coded = static_cast<std::int64_t>(
        count(side, usual, static_cast<std::uint64_t>(value < 0 ? -value : value)));
    if (coded == 0) return 0;
    return side.raw(1, value < 0 ? 1 : 0) != 0 ? -coded : coded;
  }

 private:
  struct Context {
    std::array<Tally, kMostBits> longer;
    std::array<Tally, kMostBits + 1> second;
  };
  std::array<Context, 17> contexts_;
};

}  // namespace mocapress::patterns
