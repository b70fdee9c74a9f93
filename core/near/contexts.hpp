// In which contexts the numbers of a block are coded: whole numbers of what was coded before it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "near/blocks.hpp"
#include "near/model.hpp"

namespace mocapress::near {

inline constexpr int kBands = 10;
inline constexpr int kSpectrum = 27;
inline constexpr std::size_t kChannelContexts = 128;
inline constexpr int kMostMagnitude = 2047;  // in contexts

// 2 log2 and 3 log2 of 1 + x / 16, the first rounded, the second down.
inline int halves(int x) {
  const auto v = static_cast<std::uint64_t>(16 + std::min(x, 32767));
  return (static_cast<int>(std::bit_width(v * v * v * v)) - 16) >> 1;
}
inline int thirds(int x) {
  const auto v = static_cast<std::uint64_t>(16 + std::min(x, 32767));
  return static_cast<int>(std::bit_width(v * v * v)) - 13;
}
inline int level(int x, int count) { return std::min(halves(x), count - 1); }
inline int octave(int length) { return static_cast<int>(std::bit_width(unsigned(length))) - 1; }

// Bands of the sines of blocks of every length, coarse and fine.
class Bands {
 public:
  Bands() {
    for (int length = kShortest; length <= kLongest; length *= 2) {
      for (int k = 1; k < length; ++k) {
        const std::size_t place = place_of(k, length);
        coarse_[place] = static_cast<std::uint8_t>(std::min(thirds(3840 * k / length) / 2, 9));
        fine_[place] = static_cast<std::uint8_t>(std::min(thirds(7680 * k / length), 26));
      }
      int behind = length;
      for (int k = length - 1; k > 0; --k) {
        if (k + 1 < length && fine(k, length) != fine(k + 1, length)) behind = k + 1;
        behind_[place_of(k, length)] = static_cast<std::uint16_t>(behind);
      }
    }
  }
  int coarse(int k, int length) const { return coarse_[place_of(k, length)]; }
  int fine(int k, int length) const { return fine_[place_of(k, length)]; }
  // The first sine behind the fine band of sine k.
  int behind(int k, int length) const { return behind_[place_of(k, length)]; }

 private:
  static std::size_t place_of(int k, int length) {
    return static_cast<std::size_t>(length) + static_cast<std::size_t>(k);
  }

  std::array<std::uint8_t, std::size_t{2} * kLongest> coarse_{}, fine_{};
  std::array<std::uint16_t, std::size_t{2} * kLongest> behind_{};
};

inline const Bands& bands() {
  static const Bands kBands;
  return kBands;
}

// What a block is coded beside: the channel's block before it, and those of the three moving
// channels before it that are there in its middle, of the first also at its start and its end.
struct Around {
  const Block* before = nullptr;
  std::array<const Block*, 3> beside{};
  const Block* at_start = nullptr;
  const Block* at_end = nullptr;
  int channel = 0;                                    // its contexts
  const std::array<int, kSpectrum>* usual = nullptr;  // magnitudes of its bands, in 1/256
};

// 16 times the magnitude at sine k of a block of `length` frames, as another block has it.
inline int seen(const Block* other, int k, int length) {
  static constexpr std::array<int, 11> kRoots = {45,  64,  91,  128,  181, 256,
                                                 362, 512, 724, 1024, 1448};
  if (other == nullptr) return 0;
  const int apart = octave(length) - octave(other->length);
  int at = apart > 0 ? (k + (1 << (apart - 1))) >> apart : k << -apart;
  at = std::max(at, 1);
  if (at >= other->length) return 0;
  const int number = std::min(std::abs(other->numbers[at]), kMostMagnitude);
  return (16 * number * kRoots[static_cast<std::size_t>(apart) + 5]) >> 8;
}

inline int magnitude_at(const Block* block, int k) {
  if (block == nullptr || k >= block->length) return 0;
  return std::min(std::abs(block->numbers[k]), kMostMagnitude);
}

// 0: no block; else 1 to 9, its class beside those of blocks of this length.
inline int relative_class(const Block* block, int length) {
  if (block == nullptr) return 0;
  const int apart = 2 * (octave(length) - octave(block->length));
  return std::clamp(1 + block->of_class + apart, 1, 9);
}

inline Context class_context(const Around& around, int length, int knot) {
  const int size = octave(length), a = relative_class(around.before, length),
            b = relative_class(around.beside[0], length),
            d = relative_class(around.beside[1], length), z = std::min(3, std::abs(knot));
  Context x;
  x.at = {a * 10 + size, a * 10 + b,    around.channel * 10 + size,           std::min(23, a + b),
          size * 10 + b, d * 10 + size, (a * 4 + z) * 3 + std::min(2, b / 2), b * 10 + d};
  x.first_set = (around.before != nullptr ? 1 : 0) + 2 * std::min(z, 2);
  x.second_set = size;
  return x;
}

inline Context split_context(const Around& around, int length) {
  const auto relative = [&](const Block* block) {
    if (block == nullptr) return 0;
    return std::clamp(octave(length) - octave(block->length), -1, 3) + 2;
  };
  const auto state = [](const Block* block) {
    if (block == nullptr) return 0;
    return block->of_class > 0 ? 3 : block->numbers[0] == 0 ? 1 : 2;
  };
  const int size = octave(length), a = relative(around.before), b = relative(around.beside[0]),
            d = relative(around.beside[1]), e = relative(around.at_start),
            before = state(around.before);
  Context x;
  x.at = {
      a * 10 + size, a * 6 + b,         around.channel * 10 + size, b * 4 + state(around.beside[0]),
      b * 10 + size, size * 4 + before, (b * 6 + d) * 4 + before,   (b * 6 + e) * 6 + a};
  x.first_set = a;
  x.second_set = size;
  return x;
}

inline Context knot_context(const Around& around, int length) {
  const int before = 16 * magnitude_at(around.before, 0),
            beside = 16 * magnitude_at(around.at_end, 0), size = octave(length);
  int low = 0;
  for (int k = 1; k < 4; ++k) low += 16 * magnitude_at(around.before, k);
  Context x;
  x.at = {level(before, 12) * 10 + size,
          level(before, 10) * 10 + level(low, 10),
          around.channel * 10 + size,
          std::min(23, thirds(before + low)),
          size * 10 + level(low, 10),
          level(low, 12) * 10 + level(before, 10),
          level(beside, 12) * 12 + level(before, 12),
          level(beside, 12) * 12 + size};
  x.first_set = (around.before != nullptr ? 1 : 0) + (around.at_end != nullptr ? 2 : 0);
  x.second_set = size;
  return x;
}

// What the context of a number is made of, but for the numbers of its own block.
struct Surroundings {
  int before, beside, further, usual, band, lefts;
};

inline Surroundings surroundings(const Around& around, const Block& block, int k) {
  const int n = block.length;
  const auto& [one, two, three] = around.beside;
  const int left = end_of(block.of_class, n) - k;
  return {
      seen(around.before, k - 1, n) + 2 * seen(around.before, k, n) + seen(around.before, k + 1, n),
      2 * seen(one, k, n) + seen(one, k - 1, n) + seen(one, k + 1, n) + seen(two, k, n) +
          seen(three, k, n),
      2 * (seen(two, k, n) + seen(three, k, n)) + seen(two, k + 1, n) + seen(three, k + 1, n),
      (*around.usual)[static_cast<std::size_t>(bands().fine(k, n))] / 4,
      bands().coarse(k, n),
      left == 0  ? 0
      : left < 3 ? 1
                 : 2};
}

// The four magnitudes before a number in its block, the nearest first.
using Nearest = std::array<int, 4>;

inline Context number_context(const Around& around, const Surroundings& found,
                              const Nearest& nearest) {
  const auto& [before, beside, further, usual, band, lefts] = found;
  const auto& [m1, m2, m3, m4] = nearest;
  const int near = 32 * m1 + 16 * m2 + 8 * (m3 + m4);
  const int all = (19 * near + 11 * before + 8 * beside) >> 4;
  const int whole = (13 * near + 8 * before + 5 * beside + 3 * further + 13 * usual) >> 4;
  Context x;
  x.at = {level(near, 12) * 10 + band,
          level(before, 10) * 10 + level(beside, 10),
          around.channel * 10 + band,
          std::min(23, thirds(whole)),
          (std::min(3, m1) * 4 + std::min(3, m2)) * 10 + level(beside, 10),
          level(near, 12) * 10 + level(before, 10),
          level(2 * usual, 12) * 12 + level(near, 12),
          (level(2 * usual, 12) * 12 + level(before + beside, 12)) * 3 + lefts};
  x.first_set = std::min(7, level(all, 16) / 2) + (around.before != nullptr ? 8 : 0);
  x.second_set = std::min(5, level(whole, 12) / 2) * 10 + band;
  return x;
}

inline Context number_context(const Around& around, const Block& block, int k) {
  const auto own = [&](int i) { return i < 1 ? 0 : magnitude_at(&block, i); };
  return number_context(around, surroundings(around, block, k),
                        {own(k - 1), own(k - 2), own(k - 3), own(k - 4)});
}

// Of the sign of the knot, k = 0, or a sine.
inline Context sign_context(const Around& around, const Block& block, int k) {
  const auto sign = [](const Block& of, int i) {
    return i < 0 || of.numbers[i] == 0 ? 0 : of.numbers[i] < 0 ? 1 : 2;
  };
  const int place = std::min(k, 9), s1 = k >= 2 ? sign(block, k - 1) : 0,
            s2 = k >= 3 ? sign(block, k - 2) : 0, knot = k > 0 ? sign(block, 0) : 0;
  int beside = 0, next = 0;
  const Block* other = around.beside[0];
  if (other != nullptr && other->start == block.start && other->length == block.length) {
    beside = sign(*other, k);
    if (k >= 2) next = sign(*other, k - 1);
  }
  const int agree = beside == 0 || next == 0 || s1 == 0 ? 0 : s1 == next ? 1 : 2;
  const int pair = s1 * 3 + s2, parity = k == 0 ? 0 : 1 + k % 2;
  Context x;
  x.at = {pair * 10 + place,
          knot * 10 + place,
          around.channel * 9 + beside * 3 + s1,
          beside * 3 + agree,
          knot * 9 + pair,
          (beside * 3 + s1) * 10 + place,
          pair * 9 + beside * 3 + agree,
          (around.channel * 3 + parity) * 3 + knot};
  x.first_set = k == 0 ? 0 : 1;
  x.second_set = place;
  return x;
}

}  // namespace mocapress::near
