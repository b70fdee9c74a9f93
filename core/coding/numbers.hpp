// Whole numbers coded by any side of coding/sides.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "coding/bit.hpp"

namespace mocapress {

// A symbol of kBits bits: every bit, from the highest, has a model for each prefix.
template <int kBits>
class BitTree {
 public:
  BitTree() = default;
  // The chances of a 0 at first, in 1/65536, from 15 to 65520, by the prefix.
  explicit BitTree(const std::array<std::uint16_t, std::size_t{1} << kBits>& chances) {
    for (std::size_t i = 0; i < chances.size(); ++i) models_[i] = Bit(chances[i]);
  }

  template <class Side>
  unsigned code(Side& side, unsigned symbol) {
    unsigned prefix = 1;
    for (int i = kBits; i-- > 0;) {
      const bool one = side.bit(models_[prefix], (symbol >> i & 1) != 0);
      prefix = prefix << 1 | (one ? 1 : 0);
    }
    return prefix - (1u << kBits);
  }

  template <class Visit>
  void visit(Visit&& each) {
    for (auto& model : models_) model.visit(each);
  }

 private:
  std::array<Bit, std::size_t{1} << kBits> models_;
};

// A number whose length in bits is known: what is below its leading 1 is raw.
template <class Side>
std::uint64_t code_below_leading(Side& side, int length, std::uint64_t value) {
  if (length < 2) return static_cast<std::uint64_t>(length);
  const std::uint64_t top = std::uint64_t{1} << (length - 1);
  return top | side.raw(length - 1, value & (top - 1));
}

// One of `count` equally likely numbers; above 2^16 the low bits are raw.
template <class Side>
std::uint64_t code_uniform(Side& side, std::uint64_t count, std::uint64_t value) {
  if (count <= 1) {
    if (count == 0) side.fail();
    return 0;
  }
  const int low = std::max(static_cast<int>(std::bit_width(count - 1)) - 16, 0);
  const std::uint64_t high = side.uniform(((count - 1) >> low) + 1, value >> low);
  const std::uint64_t below = low > 0 ? side.raw(low, value & ((std::uint64_t{1} << low) - 1)) : 0;
  const std::uint64_t coded = high << low | below;
  if (coded < count) return coded;
  side.fail();
  return count - 1;
}

// A difference of magnitude < 2^(2^kLengthBits - 1): its bit length is modelled (Elias gamma); the
// sign and the bits below the leading one are raw.
template <int kLengthBits>
class Difference {
 public:
  template <class Side>
  std::int64_t code(Side& side, std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    std::uint64_t magnitude = value < 0 ? 0 - bits : bits;
    const auto width = static_cast<unsigned>(std::bit_width(magnitude));
    const int length = static_cast<int>(std::min(lengths_.code(side, width), 64u));
    if (length == 0) return 0;
    const bool negative = side.raw(1, value < 0 ? 1 : 0) != 0;
    magnitude = code_below_leading(side, length, magnitude);
    return static_cast<std::int64_t>(negative ? 0 - magnitude : magnitude);
  }

 private:
  BitTree<kLengthBits> lengths_;
};

}  // namespace mocapress
