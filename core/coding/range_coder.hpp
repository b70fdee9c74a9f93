// An adaptive binary range coder, beside a stream of bits that no model can shorten.
//
// Coded and raw bits lie apart, so that raw bits cost no arithmetic:
//   varint size of the coded part | coded part | raw part, filled from the lowest bit up
// The decoder reads zeros past the end of either part, and says so when asked.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "coding/bit.hpp"

namespace mocapress {

class RangeEncoder {
 public:
  void bit(Bit& model, bool one) {
    chance(model.chance_of_zero(), one);
    model.learn(one);
  }

  // A bit whose chance of being 0 is 0 < chance_of_zero < 65536, in 1/65536.
  void chance(std::uint32_t chance_of_zero, bool one) {
    const std::uint64_t bound = (range_ >> 16) * chance_of_zero;
    narrow(one ? bound : 0, one ? range_ - bound : bound);
  }

  // `value` < count <= 2^17, all equally likely.
  void uniform(std::uint64_t value, std::uint64_t count) {
    const std::uint64_t each = range_ / count;
    narrow(each * value, each);
  }

  // `value` < 2^count, count <= 64.
  void raw(std::uint64_t value, int count) {
    if (count > 32) {
      raw(value & 0xffffffff, 32);
      value >>= 32;
      count -= 32;
    }
    raw_held_ |= value << raw_count_;
    raw_count_ += count;
    if (raw_count_ >= 32) {
      for (int i = 0; i < 4; ++i) put_raw_byte();
    }
  }

  // About how many bytes there are by now.
  std::size_t size() const { return coded_.size() + raw_.size(); }

  // What was coded; the encoder is used up.
  Bytes finish() {
    flush();
    Bytes bytes;
    while (raw_count_ > 0) put_raw_byte();
    std::size_t size = coded_.size();
    for (; size >= 0x80; size >>= 7) bytes.push_back(static_cast<std::uint8_t>(size | 0x80));
    bytes.push_back(static_cast<std::uint8_t>(size));
    bytes.insert(bytes.end(), coded_.begin(), coded_.end());
    bytes.insert(bytes.end(), raw_.begin(), raw_.end());
    return bytes;
  }

 private:
  void narrow(std::uint64_t from, std::uint64_t range) {
    low_ += from;
    if (low_ < from) carry();
    range_ = range;
    if (range_ >> 32 == 0) {
      append(4);
      range_ <<= 32;
    }
  }

  void carry() {
    for (std::size_t i = coded_.size(); i > 0; --i) {
      if (++coded_[i - 1] != 0) return;
    }
  }

  void append(int count) {
    for (int i = 0; i < count; ++i, low_ <<= 8) {
      coded_.push_back(static_cast<std::uint8_t>(low_ >> 56));
    }
  }

  // Writes as few bytes as name a number within [low, low + range).
  void flush() {
    for (int count = 0; count <= 8; ++count) {
      const std::uint64_t below = count == 8 ? 0 : ~std::uint64_t{0} >> (8 * count);
      const std::uint64_t number = (low_ + below) & ~below;
      if (number - low_ >= range_) continue;
      if (low_ + below < low_) carry();
      low_ = number;
      return append(count);
    }
  }

  void put_raw_byte() {
    raw_.push_back(static_cast<std::uint8_t>(raw_held_));
    raw_held_ >>= 8;
    raw_count_ -= 8;
  }

  std::uint64_t low_ = 0;
  std::uint64_t range_ = ~std::uint64_t{0};
  Bytes coded_;
  std::uint64_t raw_held_ = 0;
  int raw_count_ = 0;
  Bytes raw_;
};

class RangeDecoder {
 public:
  explicit RangeDecoder(ByteView bytes) {
    std::uint64_t size = 0;
    std::size_t start = 0;
    bool complete = false;
    while (!complete && start < std::min<std::size_t>(bytes.size(), 9)) {
      size |= std::uint64_t{bytes[start] & 0x7fu} << (7 * start);
      complete = bytes[start++] < 0x80;
    }
    well_formed_ = complete && size <= bytes.size() - start;
    if (well_formed_) {
      coded_ = bytes.subspan(start, size);
      raw_ = bytes.subspan(start + size);
    }
    code_ = next_code_word();
    code_ = code_ << 32 | next_code_word();
  }

  bool bit(Bit& model) {
    const bool one = chance(model.chance_of_zero());
    model.learn(one);
    return one;
  }

  bool chance(std::uint32_t chance_of_zero) {
    const std::uint64_t bound = (range_ >> 16) * chance_of_zero;
    const bool one = code_ >= bound;
    narrow(one ? bound : 0, one ? range_ - bound : bound);
    return one;
  }

  std::uint64_t uniform(std::uint64_t count) {
    const std::uint64_t each = range_ / count;
    const std::uint64_t value = std::min(code_ / each, count - 1);
    narrow(each * value, each);
    return value;
  }

  // count <= 64
  std::uint64_t raw(int count) {
    if (count > 32) {
      const std::uint64_t low = raw(32);
      return low | raw(count - 32) << 32;
    }
    if (raw_count_ < count) {
      raw_held_ |= std::uint64_t{next_raw_word()} << raw_count_;
      raw_count_ += 32;
    }
    const std::uint64_t value = raw_held_ & ((std::uint64_t{1} << count) - 1);
    raw_held_ >>= count;
    raw_count_ -= count;
    return value;
  }

  // Whether the sizes are sound and nothing was read that is not there.
  bool sound() const {
    return well_formed_ && coded_read_ <= coded_.size() + 8 && raw_bits() <= 8 * raw_.size();
  }

  // Whether, besides, nothing is left over.
  bool exhausted() const {
    return sound() && coded_.size() <= coded_read_ && raw_.size() == (raw_bits() + 7) / 8 &&
           raw_held_ == 0;
  }

 private:
  void narrow(std::uint64_t from, std::uint64_t range) {
    code_ -= from;
    range_ = range;
    if (range_ >> 32 == 0) {
      code_ = code_ << 32 | next_code_word();
      range_ <<= 32;
    }
  }

  std::uint32_t next_code_word() {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) word = word << 8 | byte(coded_, coded_read_ + i);
    coded_read_ += 4;
    return word;
  }

  std::uint32_t next_raw_word() {
    std::uint32_t word = 0;
    for (std::size_t i = 4; i-- > 0;) word = word << 8 | byte(raw_, raw_read_ + i);
    raw_read_ += 4;
    return word;
  }

  static std::uint32_t byte(ByteView bytes, std::size_t at) {
    return at < bytes.size() ? bytes[at] : 0;
  }

  std::size_t raw_bits() const { return 8 * raw_read_ - static_cast<std::size_t>(raw_count_); }

  bool well_formed_ = false;
  ByteView coded_;
  ByteView raw_;
  std::size_t coded_read_ = 0;
  std::size_t raw_read_ = 0;
  std::uint64_t code_ = 0;
  std::uint64_t range_ = ~std::uint64_t{0};
  std::uint64_t raw_held_ = 0;
  int raw_count_ = 0;
};

}  // namespace mocapress
