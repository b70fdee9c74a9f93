// Bytes, and bits whose chances adapt: what all coders have to do with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mocapress {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

// The chance that a bit is 0, learned at two rates: the fast follows changes, the slow is precise.
class Bit {
 public:
  Bit() = default;
  explicit Bit(std::uint16_t chance_of_zero) : fast_(chance_of_zero), slow_(chance_of_zero) {}

  // In 1/65536, from 15 to 65521.
  std::uint32_t chance_of_zero() const { return (std::uint32_t{fast_} + slow_) >> 1; }

  void learn(bool one) {
    fast_ = moved<4>(fast_, one);
    slow_ = moved<7>(slow_, one);
  }

  // What was learned, for a coder that begins where another ended.
  template <class Visit>
  void visit(Visit&& each) {
    each(fast_);
    each(slow_);
  }

 private:
  template <int kRate>
  static std::uint16_t moved(std::uint16_t chance, bool one) {
    const int target = one ? 15 : 65520 + (1 << kRate);
    return static_cast<std::uint16_t>(chance + ((target - chance) >> kRate));
  }

  std::uint16_t fast_ = 1 << 15;
  std::uint16_t slow_ = 1 << 15;
};

}  // namespace mocapress
