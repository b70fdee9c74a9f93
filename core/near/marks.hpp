// What stands behind the curves of a chunk: corrections, and numbers that are kept as they are.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "near/blocks.hpp"
#include "near/coder.hpp"

namespace mocapress::near {

// Of a frame: so many times a part of its step is added to some channels.
struct Correction {
  std::size_t frame;
  int fineness;                                             // 2^(1 - fineness) steps
  std::vector<std::pair<std::size_t, std::int32_t>> added;  // channel, how often; never 0
};

// Consecutive frames of a channel whose numbers are kept.
struct Kept {
  std::size_t channel, first;
  std::vector<std::uint64_t> bits;
};

inline double part_of(double step, int fineness) { return std::ldexp(step, 1 - fineness); }

template <class Side>
class Marks {
 public:
  Marks(Side& side, std::size_t frames, std::size_t channels)
      : side_(side), frames_(frames), channels_(channels) {}

  // Both call `each` with what was coded, and stop where a place cannot be.
  template <class Each>
  void corrections(const std::vector<Correction>& given, Each&& each) {
    const std::size_t count = counts_.code(side_, given.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < count; ++i) {
      Correction one = i < given.size() ? given[i] : Correction{next, 0, {{0, 1}}};
      one.frame = next + gaps_.code(side_, one.frame - next);
      if (!fits(one.frame, frames_)) return;
      next = one.frame + 1;
      one.fineness = static_cast<int>(finenesses_.code(side_, static_cast<unsigned>(one.fineness)));
      const std::size_t size = sizes_.code(side_, one.added.size() - 1) + 1;
      one.added.resize(size < channels_ ? size : channels_, {0, 1});
      std::size_t channel = 0;
      for (auto& [index, times] : one.added) {
        index = channel + places_.code(side_, index < channel ? 0 : index - channel);
        if (!fits(index, channels_)) return;
        channel = index + 1;
        const auto size_of = static_cast<std::uint64_t>(std::abs(std::int64_t{times}) - 1);
        const auto more = times_.code(side_, size_of) & 0x3fffffff;
        const bool negative = side_.bit(negative_, times < 0);
        times = static_cast<std::int32_t>(more) + 1;
        if (negative) times = -times;
      }
      each(one);
    }
  }

  template <class Each>
  void kept(const std::vector<Kept>& given, Each&& each) {
    const std::size_t count = counts_.code(side_, given.size());
    std::size_t channel = 0, next = 0;
    std::uint64_t last = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Kept one = i < given.size() ? given[i] : Kept{channel, next, {}};
      const std::size_t further = places_.code(side_, one.channel - channel);
      if (further > 0) next = 0;
      channel += further;
      if (!fits(channel, channels_)) return;
      const std::size_t first = next + gaps_.code(side_, one.first - next);
      const std::size_t size = sizes_.code(side_, one.bits.size() - 1) + 1;
      if (!fits(first, frames_) || !fits(size - 1, frames_ - first)) return;
      next = first + size;
      for (std::size_t k = 0; k < size; ++k) {
        const std::uint64_t bits = k < one.bits.size() ? one.bits[k] : 0;
        if (!side_.bit(again_, bits == last)) last = side_.raw(64, bits);
        if (Side::kReading && !sound()) return;
        each(channel, first + k, std::bit_cast<double>(last));
      }
    }
  }

 private:
  bool fits(std::size_t place, std::size_t count) {
    if (place >= count) side_.fail();
    return place < count && (!Side::kReading || sound());
  }
  bool sound() const {
    if constexpr (Side::kReading) return side_.sound();
    return true;
  }

  Side& side_;
  std::size_t frames_, channels_;
  Count counts_, gaps_, sizes_, places_, times_;
  BitTree<4> finenesses_;
  Bit negative_, again_;
};

}  // namespace mocapress::near
