// Both directions of the fast levels' coder as one piece of code, as in exact/sides.hpp.
#pragma once

#include <cstdint>

#include "coding/rans.hpp"

namespace mocapress::exact {

class FastWriting {
 public:
  static constexpr bool kReading = false;

  void put(Interval interval) { encoder_.put(interval); }
  bool bit(Bit& model, bool one) {
    encoder_.bit(model, one);
    return one;
  }
  std::uint32_t uniform(std::uint32_t count, std::uint32_t value) {
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

  Bytes finish() const { return encoder_.finish(); }

 private:
  RansEncoder encoder_;
};

class FastReading {
 public:
  static constexpr bool kReading = true;

  explicit FastReading(ByteView bytes) : decoder_(bytes) {}

  std::uint32_t peek() const { return decoder_.peek(); }
  void take(Interval interval) { decoder_.take(interval); }
  bool bit(Bit& model, bool) { return decoder_.bit(model); }
  std::uint32_t uniform(std::uint32_t count, std::uint32_t) { return decoder_.uniform(count); }
  std::uint64_t raw(int count, std::uint64_t) { return decoder_.raw(count); }
  template <int kBits>
  unsigned symbol(BitTree<kBits>& tree, unsigned) {
    return tree.decode(decoder_);
  }
  void fail() { failed_ = true; }

  bool sound() const { return !failed_ && decoder_.sound(); }
  bool exhausted() const { return !failed_ && decoder_.exhausted(); }

 private:
  RansDecoder decoder_;
  bool failed_ = false;
};

}  // namespace mocapress::exact
