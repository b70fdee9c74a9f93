// Both directions of a coder as one piece of code: the writing side codes what it is given, the
// reading side ignores it; both return what was coded.
#pragma once

#include <cstdint>

#include "coding/range_coder.hpp"
#include "coding/rans.hpp"

namespace mocapress {

template <class Encoder>
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
  void put(Interval interval) { encoder_.put(interval); }
  void fail() {}

  std::size_t size() const { return encoder_.size(); }
  Bytes finish() { return encoder_.finish(); }

 private:
  Encoder encoder_;
};

template <class Decoder>
class Reading {
 public:
  static constexpr bool kReading = true;

  explicit Reading(ByteView bytes) : decoder_(bytes) {}

  bool bit(Bit& model, bool) { return decoder_.bit(model); }
  bool chance(std::uint32_t chance_of_zero, bool) { return decoder_.chance(chance_of_zero); }
  std::uint64_t uniform(std::uint64_t count, std::uint64_t) { return decoder_.uniform(count); }
  std::uint64_t raw(int count, std::uint64_t) { return decoder_.raw(count); }
  std::uint32_t peek() const { return decoder_.peek(); }
  void take(Interval interval) { decoder_.take(interval); }
  void fail() { failed_ = true; }

  // Whether nothing impossible was read; checked now and then, so that a short stream ends soon.
  bool sound() const { return !failed_ && decoder_.sound(); }
  bool exhausted() const { return !failed_ && decoder_.exhausted(); }

 private:
  Decoder decoder_;
  bool failed_ = false;
};

using RangeWriting = Writing<RangeEncoder>;
using RangeReading = Reading<RangeDecoder>;
using RansWriting = Writing<RansEncoder>;
using RansReading = Reading<RansDecoder>;

}  // namespace mocapress
