// A range asymmetric numeral system (rANS): everything that is coded is an interval of 2^16, so
// that symbols of a table, adaptive bits and raw bits are one stream, and cost the same.
//
//   state, 8 bytes | words of 4 bytes, little-endian
// The state is at least 2^31 and below 2^63; a word is taken whenever it falls below. J. Duda,
// "Asymmetric numeral systems", 2013. What is read first is coded last, so a writer keeps all
// intervals until the end; it begins with the state 2^31, at which a reader must end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/bit.hpp"

namespace mocapress {

inline constexpr int kRansBits = 16;
inline constexpr std::uint64_t kRansLowest = std::uint64_t{1} << 31;

// From `start` on, `size` < 2^16 of 2^16.
struct Interval {
  std::uint16_t start;
  std::uint16_t size;
};

// The interval of `value` among `count` <= 2^16 that are equally likely, within rounding.
inline Interval uniform_interval(std::uint32_t value, std::uint32_t count) {
  const std::uint32_t from = ((value << kRansBits) + count - 1) / count;
  const std::uint32_t to = (((value + 1) << kRansBits) + count - 1) / count;
  return {static_cast<std::uint16_t>(from), static_cast<std::uint16_t>(to - from)};
}

class RansEncoder {
 public:
  void put(Interval interval) { intervals_.push_back(interval); }

  void bit(Bit& model, bool one) {
    const auto zero = static_cast<std::uint16_t>(model.chance_of_zero());
    put(one ? Interval{zero, static_cast<std::uint16_t>(0 - zero)} : Interval{0, zero});
    model.learn(one);
  }

  // `value` < count <= 2^15
  void uniform(std::uint64_t value, std::uint64_t count) {
    put(uniform_interval(static_cast<std::uint32_t>(value), static_cast<std::uint32_t>(count)));
  }

  // `value` < 2^count, count <= 64
  void raw(std::uint64_t value, int count) {
    for (; count > 0; count -= kRansBits, value >>= kRansBits) {
      const int bits = std::min(count, kRansBits);
      const auto size = static_cast<std::uint16_t>(1u << (kRansBits - bits));
      put({static_cast<std::uint16_t>(value << (kRansBits - bits)), size});
    }
  }

  Bytes finish() const {
    std::vector<std::uint32_t> words;
    std::uint64_t state = kRansLowest;
    for (auto it = intervals_.rbegin(); it != intervals_.rend(); ++it) {
      const std::uint64_t size = it->size;
      if (state >= size << (63 - kRansBits)) {
        words.push_back(static_cast<std::uint32_t>(state));
        state >>= 32;
      }
      state = (state / size << kRansBits) + state % size + it->start;
    }
    words.push_back(static_cast<std::uint32_t>(state >> 32));
    words.push_back(static_cast<std::uint32_t>(state));
    Bytes bytes;
    bytes.reserve(4 * words.size());
    for (auto word = words.rbegin(); word != words.rend(); ++word) {
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(*word >> 8 * i));
    }
    return bytes;
  }

 private:
  std::vector<Interval> intervals_;
};

class RansDecoder {
 public:
  explicit RansDecoder(ByteView bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {
    well_formed_ = bytes.size() >= 8 && bytes.size() % 4 == 0;
    if (!well_formed_) end_ = at_;
    const std::uint64_t low = next_word();
    state_ = low | std::uint64_t{next_word()} << 32;
  }

  // Where in 2^16 the next interval is; then it is to be taken.
  std::uint32_t peek() const { return static_cast<std::uint32_t>(state_ & 0xffff); }

  void take(Interval interval) {
    state_ = interval.size * (state_ >> kRansBits) + (state_ & 0xffff) - interval.start;
    if (state_ < kRansLowest) state_ = state_ << 32 | next_word();
  }

  bool bit(Bit& model) {
    const auto zero = static_cast<std::uint16_t>(model.chance_of_zero());
    const bool one = peek() >= zero;
    take(one ? Interval{zero, static_cast<std::uint16_t>(0 - zero)} : Interval{0, zero});
    model.learn(one);
    return one;
  }

  std::uint64_t uniform(std::uint64_t count) {
    const auto small = static_cast<std::uint32_t>(count);
    const std::uint32_t value = peek() * small >> kRansBits;
    take(uniform_interval(value, small));
    return value;
  }

  std::uint64_t raw(int count) {
    std::uint64_t value = 0;
    for (int done = 0; done < count; done += kRansBits) {
      const int bits = std::min(count - done, kRansBits);
      const std::uint64_t part = peek() >> (kRansBits - bits);
      const auto size = static_cast<std::uint16_t>(1u << (kRansBits - bits));
      take({static_cast<std::uint16_t>(part << (kRansBits - bits)), size});
      value |= part << done;
    }
    return value;
  }

  // Whether nothing was read that is not there.
  bool sound() const { return well_formed_ && missing_ == 0; }

  // Whether, besides, nothing is left over.
  bool exhausted() const { return sound() && at_ == end_ && state_ == kRansLowest; }

 private:
  std::uint32_t next_word() {
    if (at_ == end_) {
      ++missing_;
      return 0;
    }
    const std::uint32_t word = at_[0] | std::uint32_t{at_[1]} << 8 | std::uint32_t{at_[2]} << 16 |
                               std::uint32_t{at_[3]} << 24;
    at_ += 4;
    return word;
  }

  const std::uint8_t* at_;
  const std::uint8_t* end_;
  std::uint64_t state_ = 0;
  std::size_t missing_ = 0;
  bool well_formed_ = false;
};

}  // namespace mocapress
