// Coding the numbers of a chunk, in both directions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/numbers.hpp"
#include "near/blocks.hpp"
#include "near/contexts.hpp"
#include "near/model.hpp"

namespace mocapress::near {

// A number of 0 or more: its length in bits is modelled.
class Count {
 public:
  template <class Side>
  std::uint64_t code(Side& side, std::uint64_t value) {
    const auto width = static_cast<unsigned>(std::bit_width(value + 1));
    const auto length = static_cast<int>(lengths_.code(side, width));
    if (length == 0) {
      side.fail();
      return 0;
    }
    return code_below_leading(side, length, value + 1) - 1;
  }

 private:
  BitTree<6> lengths_;
};

// A channel while a chunk is coded.
struct Channel {
  std::size_t index;  // of its column
  std::array<int, kSpectrum> usual{};
  std::vector<Block> blocks;  // of this span
  std::vector<std::int32_t> numbers, before_numbers;
  Block before{};
  bool follows = false;  // `before` is there
  double last = 0;       // its value in the frame before the span

  void begin_span(int length) {
    if (!blocks.empty()) {
      follows = true;
      before_numbers.swap(numbers);
      before = blocks.back();
      before.numbers = before_numbers.data() + before.start;
      blocks.clear();
    }
    numbers.assign(static_cast<std::size_t>(length), 0);
  }
};

// What is learned of the numbers of blocks.
struct Models {
  Model knots{
      kMagnitudeDecisions, {120, 100, kChannelContexts * 10, 24, 100, 120, 144, 144}, 4, 10};
  Model classes{kEnds.size() - 1, {100, 100, kChannelContexts * 10, 24, 100, 100, 120, 100}, 6, 10};
  Model sines{
      kMagnitudeDecisions + 1, {120, 100, kChannelContexts * 10, 24, 160, 120, 144, 432}, 16, 60};
  Model splits{1, {60, 36, kChannelContexts * 10, 24, 60, 40, 144, 216}, 6, 10};
  Model signs{1, {90, 30, kChannelContexts * 9, 9, 27, 90, 81, kChannelContexts * 9}, 2, 10};
};

// Of the channels that move, all that was coded so far, and what was learned of it.
class Coder : public Models {
 public:
  Coder() = default;
  explicit Coder(const Models& learned) : Models(learned) {}

  // What a block at `start` of channel `i` of the moving ones is coded beside, when this block of
  // the span, if any, stands before it.
  Around around(std::size_t i, const Block* before, int start, int length) const {
    const Channel& own = channels[i];
    Around found;
    found.before = before != nullptr ? before : own.follows ? &own.before : nullptr;
    for (std::size_t k = 0; k < 3 && k < i; ++k) {
      found.beside[k] = at(channels[i - 1 - k], start + length / 2);
    }
    if (i > 0) {
      found.at_start = at(channels[i - 1], start);
      found.at_end = at(channels[i - 1], start + length - 1);
    }
    found.channel = static_cast<int>(own.index % kChannelContexts);
    found.usual = &own.usual;
    return found;
  }

  template <class Vector, class Side>
  MOCAPRESS_IN_PLACE bool split(Side& side, const Around& around, int length, bool is_split) {
    return Mixing<Vector>::code(side, splits.at(split_context(around, length)), 0, is_split);
  }

  // Codes a block of channel `i` and learns from it. Its numbers are those of the channel.
  template <class Vector, class Side>
  MOCAPRESS_IN_PLACE void code(Side& side, std::size_t i, const Around& around, Block& block) {
    const int n = block.length;
    std::int32_t* const numbers = channels[i].numbers.data() + block.start;
    Block wanted = block;
    std::vector<std::int32_t> given;
    if constexpr (!Side::kReading) given.assign(block.numbers, block.numbers + n);
    const auto told = [&](int k) { return given.empty() ? 0 : given[static_cast<std::size_t>(k)]; };
    block.numbers = numbers;
    std::fill(numbers, numbers + n, 0);
    const Model::Place of_knot = knots.at(knot_context(around, n));
    number<Vector>(side, of_knot, Quantiser::only, around, block, 0, told(0));
    const Model::Place of_class = classes.at(class_context(around, n, numbers[0]));
    block.of_class = code_class<Vector>(side, of_class, n, wanted.of_class);
    const int end = end_of(block.of_class, n);
    std::size_t state = 0;
    for (int k = 1; k <= end; ++k) {
      const Model::Place place = sines.at(number_context(around, block, k));
      const Quantiser quantiser = is_odd(state) ? Quantiser::odd : Quantiser::even;
      number<Vector>(side, place, quantiser, around, block, k, told(k));
      state = next_state(state, numbers[k]);
    }
    remember(channels[i].usual, block);
  }

  std::vector<Channel> channels;

 private:
  static const Block* at(const Channel& channel, int frame) {
    for (const Block& block : channel.blocks) {
      if (frame < block.start + block.length) return &block;
    }
    return nullptr;
  }

  template <class Vector, class Side>
  MOCAPRESS_IN_PLACE void number(Side& side, const Model::Place& place, Quantiser quantiser,
                                 const Around& around, Block& block, int k, std::int32_t value) {
    const std::int64_t magnitude = code_magnitude<Vector>(side, place, quantiser, std::abs(value));
    if (magnitude == 0) return;
    const Model::Place sign = signs.at(sign_context(around, block, k));
    const bool negative = Mixing<Vector>::code(side, sign, 0, value < 0);
    block.numbers[k] = static_cast<std::int32_t>(negative ? -magnitude : magnitude);
  }

  template <class Vector, class Side>
  MOCAPRESS_IN_PLACE int code_class(Side& side, const Model::Place& place, int length, int value) {
    const int most = classes_of(length) - 1;
    for (int u = 0; u < most; ++u) {
      if (!Mixing<Vector>::code(side, place, static_cast<std::size_t>(u), value > u)) return u;
    }
    return most;
  }

  // By how much of 256 the usual magnitude of a band moves to that of so many sines.
  static int rate_of(int count) {
    static const auto kRates = [] {
      std::array<std::uint8_t, kLongest> made{};
      for (int n = 0; n < kLongest; ++n) {
        int rate = 0;
        while (rate < 128 && (rate + 1) * (rate + 1) <= 838 * n) ++rate;
        made[static_cast<std::size_t>(n)] = static_cast<std::uint8_t>(rate);
      }
      return made;
    }();
    return kRates[static_cast<std::size_t>(count)];
  }

  // Moves the usual magnitudes of the bands towards those of a block.
  static void remember(std::array<int, kSpectrum>& usual, const Block& block) {
    const int end = end_of(block.of_class, block.length);
    int next = 1;
    for (int k = 1; k < block.length; k = next) {
      next = bands().behind(k, block.length);
      int sum = 0;
      for (int i = k; i < std::min(next, end + 1); ++i) sum += magnitude_at(&block, i);
      const int band = bands().fine(k, block.length), count = next - k;
      int& value = usual[static_cast<std::size_t>(band)];
      value += ((256 * sum / count - value) * rate_of(count)) >> 8;
    }
  }
};

}  // namespace mocapress::near
