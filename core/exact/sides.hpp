// Both directions of a coder as one piece of code: the writing side codes what it is given, the
// reading side ignores it; both return what was coded.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "coding/range_coder.hpp"

namespace mocapress::exact {

class Writing {
 public:
  static constexpr bool kReading = false;

  bool bit(Bit& model, bool one) {
    encoder_.bit(model, one);
    return one;
  }
  bool chance(std::uint32_t chance_of_zero, bool one) {
    encoder_.chance(chance_of_zero, one);
    return one;
  }
  std::uint64_t uniform(std::uint64_t count, std::uint64_t value) {
    encoder_.uniform(value, count);
    return value;
  }
  std::uint64_t raw(int count, std::uint64_t value) {
    encoder_.raw(value, count);
    return value;
  }
  template <int kBits>
  unsigned symbol(BitTree<kBits>& tree, unsigned symbol) {
    tree.encode(encoder_, symbol);
    return symbol;
  }
  void fail() {}

  Bytes finish() {
    Bytes bytes;
    encoder_.finish(bytes);
    return bytes;
  }

 private:
  Encoder encoder_;
};

class Reading {
 public:
  static constexpr bool kReading = true;

  explicit Reading(ByteView bytes) : decoder_(bytes) {}

  bool bit(Bit& model, bool) { return decoder_.bit(model); }
  bool chance(std::uint32_t chance_of_zero, bool) { return decoder_.chance(chance_of_zero); }
  std::uint64_t uniform(std::uint64_t count, std::uint64_t) { return decoder_.uniform(count); }
  std::uint64_t raw(int count, std::uint64_t) { return decoder_.raw(count); }
  template <int kBits>
  unsigned symbol(BitTree<kBits>& tree, unsigned) {
    return tree.decode(decoder_);
  }
  void fail() { failed_ = true; }

  // Whether nothing impossible was read; checked now and then, so that a short stream ends soon.
  bool sound() const { return !failed_ && decoder_.sound(); }
  bool exhausted() const { return !failed_ && decoder_.exhausted(); }

 private:
  Decoder decoder_;
  bool failed_ = false;
};

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

}  // namespace mocapress::exact
