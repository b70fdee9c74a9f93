// Bits whose chances are mixed of what eight contexts have seen, in whole numbers only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "numbers/lanes.hpp"

namespace mocapress::near {

inline constexpr std::size_t kContexts = 8;
inline constexpr std::size_t kInputs = 2 * kContexts;

// Logits in 1/128 and chances in 1/65536, both ways.
class Logistic {
 public:
  static constexpr int kMost = 1023;

  Logistic() {
    constexpr double kStep = 0x1.0202015600446p+0;  // e^(1/128)
    double power = 1;
    for (int z = 0; z <= kMost; ++z) {
      const int chance = static_cast<int>(65536 * power / (1 + power));
      chances_[kMost + z] = static_cast<std::uint16_t>(std::min(chance, 65529));
      chances_[kMost - z] = static_cast<std::uint16_t>(std::max(65536 - chance, 7));
      power = power * kStep;
    }
    int z = -kMost;
    for (int i = 0; i < 4096; ++i) {
      while (z < kMost && chances_[kMost + z] < 16 * i + 8) ++z;
      logits_[i] = static_cast<std::int16_t>(z);
    }
  }

  int chance(int logit) const { return chances_[kMost + std::clamp(logit, -kMost, kMost)]; }
  int logit(std::uint16_t chance) const { return logits_[chance >> 4]; }

 private:
  std::array<std::uint16_t, 2 * kMost + 1> chances_{};
  std::array<std::int16_t, 4096> logits_{};
};

inline const Logistic& logistic() {
  static const Logistic kTables;
  return kTables;
}

// Where a decision is made: a place in each of eight tables, and which weights mix them.
struct Context {
  std::array<std::int32_t, kContexts> at{};
  std::int32_t first_set = 0, second_set = 0;
};

// Whole numbers side by side, in registers that all machines have, and in wider ones. All that is
// done to them is done one by one, so that both give the same.
using Narrow = std::int32_t __attribute__((vector_size(16)));
using Wide = std::int32_t __attribute__((vector_size(32)));

template <class Vector>
MOCAPRESS_IN_PLACE Vector within(Vector numbers, std::int32_t least, std::int32_t most) {
  const Vector low = Vector{} + least, high = Vector{} + most;
  numbers = numbers < low ? low : numbers;
  return numbers > high ? high : numbers;
}

// The chance that a bit is 1, averaged over all that was seen and over the latest.
struct Counter {
  std::uint32_t chances = 0x80008000;  // the slow one, and above it the fast one
  std::uint32_t count = 0;

  std::uint16_t slow() const { return static_cast<std::uint16_t>(chances); }
  std::uint16_t fast() const { return static_cast<std::uint16_t>(chances >> 16); }
};

// How much the chances of a counter move that has seen so much, the fast one's above.
class Rates {
 public:
  constexpr Rates() {
    const auto rate = [](std::uint32_t count) { return 655360 / (10 * count + 16); };
    for (std::uint32_t n = 0; n < 256; ++n) rates_[n] = rate(n) | rate(std::min(n, 18U)) << 16;
  }
  std::int32_t of(std::uint32_t count) const { return static_cast<std::int32_t>(rates_[count]); }

 private:
  std::array<std::uint32_t, 256> rates_{};
};

inline constexpr Rates kRates;

// The weights of eight slow chances, then of the fast ones.
struct Mixer {
  std::array<std::int32_t, kInputs> weights;
  std::int32_t uses = 0;

  Mixer() { weights.fill(6000); }
};

// Symbols made of the same few decisions in many contexts.
class Model {
 public:
  // What a context has of each decision.
  struct Place {
    std::array<Counter*, kContexts> counters;
    Mixer *first, *second;
    const Logistic* tables;
  };

  Model(std::size_t decisions, const std::array<std::size_t, kContexts>& sizes,
        std::size_t first_sets, std::size_t second_sets)
      : decisions_(decisions), first_(first_sets * decisions), second_(second_sets * decisions) {
    for (std::size_t i = 0; i < kContexts; ++i) tables_[i].resize(sizes[i] * decisions);
  }

  // Codes what was learned in the tables of `which`, a bit for each, and by its mixers.
  template <class Side, class Notes>
  void code_learned(Side& side, Notes& notes, unsigned which, bool mixers) {
    for (std::size_t i = 0; i < kContexts; ++i) {
      if ((which >> i & 1) == 0) continue;
      bool known = false;
      for (std::size_t place = 0; place < tables_[i].size(); ++place) {
        if (place % decisions_ == 0) known = true;
        known = notes.counter(side, tables_[i][place], known);
      }
    }
    if (!mixers) return;
    for (auto* const set : {&first_, &second_}) {
      for (Mixer& mixer : *set) notes.mixer(side, mixer);
    }
  }

  Place at(const Context& context) {
    Place place;
    for (std::size_t i = 0; i < kContexts; ++i) {
      place.counters[i] = &tables_[i][static_cast<std::size_t>(context.at[i]) * decisions_];
    }
    place.first = &first_[static_cast<std::size_t>(context.first_set) * decisions_];
    place.second = &second_[static_cast<std::size_t>(context.second_set) * decisions_];
    place.tables = &logistic();
    return place;
  }

 private:
  std::size_t decisions_;
  std::array<std::vector<Counter>, kContexts> tables_;
  std::vector<Mixer> first_, second_;
};

// Decisions by vectors of numbers.
template <class Vector>
class Mixing {
 public:
  // The chance of a 1, in 1/65536.
  MOCAPRESS_IN_PLACE static int chance(const Model::Place& place, std::size_t decision) {
    return mixed(place, decision, inputs_of(place, decision));
  }

  template <class Side>
  MOCAPRESS_IN_PLACE static bool code(Side& side, const Model::Place& place, std::size_t decision,
                                      bool one) {
    const Inputs inputs = inputs_of(place, decision);
    const int chance = mixed(place, decision, inputs);
    one = side.chance(static_cast<std::uint32_t>(65536 - chance), one);
    const int error = (one ? 65536 : 0) - chance;
    Inputs moves;
    for (std::size_t i = 0; i < kVectors; ++i) moves[i] = inputs[i] * error;
    learn(place.first[decision], moves);
    learn(place.second[decision], moves);
    const std::int32_t target = one ? 65535 : 0;
    for (std::size_t i = 0; i < kContexts; i += kWidth) {
      learn(place.counters.data() + i, decision, target);
    }
    return one;
  }

 private:
  static constexpr std::size_t kWidth = sizeof(Vector) / sizeof(std::int32_t);
  static constexpr std::size_t kVectors = kInputs / kWidth;
  using Inputs = std::array<Vector, kVectors>;

  // As many numbers as a vector has.
  template <class Number>
  MOCAPRESS_IN_PLACE static Vector vector(Number&& number) {
    if constexpr (kWidth == 4) {
      return Vector{number(0), number(1), number(2), number(3)};
    } else {
      return Vector{number(0), number(1), number(2), number(3),
                    number(4), number(5), number(6), number(7)};
    }
  }

  MOCAPRESS_IN_PLACE static Inputs inputs_of(const Model::Place& place, std::size_t decision) {
    const Logistic& tables = *place.tables;
    Inputs inputs;
    for (std::size_t v = 0; v < kVectors / 2; ++v) {
      const auto own = [&](std::size_t i) -> const Counter& {
        return place.counters[v * kWidth + i][decision];
      };
      inputs[v] = vector([&](std::size_t i) { return tables.logit(own(i).slow()); });
      inputs[kVectors / 2 + v] = vector([&](std::size_t i) { return tables.logit(own(i).fast()); });
    }
    return inputs;
  }

  MOCAPRESS_IN_PLACE static Vector load(const std::int32_t* from) {
    Vector numbers;
    std::memcpy(&numbers, from, sizeof numbers);
    return numbers;
  }

  MOCAPRESS_IN_PLACE static int mixed(const Mixer& mixer, const Inputs& inputs) {
    Vector sums{};
    for (std::size_t i = 0; i < kVectors; ++i) {
      sums += load(mixer.weights.data() + i * kWidth) * inputs[i];
    }
    std::array<Narrow, kWidth / 4> parts;
    std::memcpy(parts.data(), &sums, sizeof sums);
    Narrow four = parts[0];
    if constexpr (kWidth > 4) four += parts[1];
    return ((four[0] + four[1]) + (four[2] + four[3])) >> 16;
  }

  MOCAPRESS_IN_PLACE static int mixed(const Model::Place& place, std::size_t decision,
                                      const Inputs& inputs) {
    const int first = mixed(place.first[decision], inputs);
    const int second = mixed(place.second[decision], inputs);
    return place.tables->chance((first + second) >> 1);
  }

  MOCAPRESS_IN_PLACE static void learn(Mixer& mixer, const Inputs& moves) {
    const int uses = mixer.uses;
    const int shift = 13 + (uses >= 32 ? 1 : 0) + (uses >= 128 ? 1 : 0) + (uses >= 512 ? 1 : 0);
    mixer.uses = uses + (uses < 512 ? 1 : 0);
    for (std::size_t i = 0; i < kVectors; ++i) {
      std::int32_t* const own = mixer.weights.data() + i * kWidth;
      const Vector moved = load(own) + ((moves[i] + (1 << (shift - 1))) >> shift);
      const Vector weights = within(moved, -131071, 131071);
      std::memcpy(own, &weights, sizeof weights);
    }
  }

  // Moves the chances of as many counters as a vector has numbers. One that has seen nothing has
  // chances of a half, so that all products are below 2^31.
  MOCAPRESS_IN_PLACE static void learn(Counter* const* counters, std::size_t decision,
                                       std::int32_t target) {
    const auto own = [&](std::size_t i) -> Counter& { return counters[i][decision]; };
    const Vector both =
        vector([&](std::size_t i) { return static_cast<std::int32_t>(own(i).chances); });
    const Vector moves = vector([&](std::size_t i) { return kRates.of(own(i).count); });
    const Vector slow = both & 0xffff, fast = (both >> 16) & 0xffff;
    const Vector slower = slow + ((target - slow) * (moves & 0xffff) >> 16);
    const Vector faster = fast + ((target - fast) * ((moves >> 16) & 0xffff) >> 16);
    const Vector moved = within(slower, 16, 65519) | within(faster, 64, 65471) << 16;
    for (std::size_t i = 0; i < kWidth; ++i) {
      own(i).chances = static_cast<std::uint32_t>(moved[i]);
      own(i).count = std::min(own(i).count + 1, 255U);
    }
  }
};

// Magnitudes: is it more than 0, than 1, ... than 13; then the length of what is above, and that.
inline constexpr int kUnary = 14;
inline constexpr int kMostLength = 29;
inline constexpr std::size_t kMagnitudeDecisions = kUnary + 18;

// How a number was rounded: by the only quantiser that there is, or by one of two.
enum class Quantiser : std::uint8_t { only, even, odd };

// Where the u-th question of a magnitude stands. The first is another one for each of two
// quantisers.
inline std::size_t decision_of(int u, Quantiser quantiser) {
  const bool later = quantiser == Quantiser::odd || (quantiser == Quantiser::even && u > 0);
  return static_cast<std::size_t>(u) + (later ? 1 : 0);
}

template <class Vector, class Side>
MOCAPRESS_IN_PLACE std::int64_t code_magnitude(Side& side, const Model::Place& place,
                                               Quantiser quantiser, std::int64_t value) {
  for (int u = 0; u < kUnary; ++u) {
    if (!Mixing<Vector>::code(side, place, decision_of(u, quantiser), value > u)) return u;
  }
  const std::int64_t above = value - kUnary + 1;
  int length = 0;
  for (; length < kMostLength; ++length) {
    const std::size_t decision = decision_of(kUnary + std::min(length, 17), quantiser);
    if (!Mixing<Vector>::code(side, place, decision, above >> (length + 1) > 0)) break;
  }
  const std::int64_t top = std::int64_t{1} << length;
  const auto below = side.raw(length, static_cast<std::uint64_t>(above & (top - 1)));
  return kUnary - 1 + top + static_cast<std::int64_t>(below);
}

}  // namespace mocapress::near
