// Bits whose chances are mixed of what eight contexts have seen, in whole numbers only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

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

// The chance that a bit is 1, averaged over all that was seen and over the latest.
struct Counter {
  std::uint16_t slow = 1 << 15, fast = 1 << 15;
  std::uint16_t count = 0;

  void learn(bool one, int most) {
    static const auto kRates = [] {
      std::array<std::int32_t, 256> made{};
      for (int n = 0; n < 256; ++n) made[n] = 655360 / (10 * n + 16);
      return made;
    }();
    const int target = one ? 65535 : 0;
    slow = moved(slow, target, kRates[count], 16);
    fast = moved(fast, target, kRates[std::min<int>(count, 18)], 64);
    if (count < most) ++count;
  }

 private:
  static std::uint16_t moved(std::uint16_t chance, int target, std::int64_t rate, int margin) {
    const auto next = chance + static_cast<int>((target - chance) * rate >> 16);
    return static_cast<std::uint16_t>(std::clamp(next, margin, 65535 - margin));
  }
};

struct Mixer {
  std::array<std::int32_t, kInputs> weights;
  std::int32_t uses = 0;

  Mixer() { weights.fill(6000); }

  int mixed(const std::array<std::int32_t, kInputs>& inputs) const {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kInputs; ++i) sum += weights[i] * inputs[i];
    return sum >> 16;
  }

  void learn(const std::array<std::int32_t, kInputs>& inputs, int error) {
    const int shift = uses < 32 ? 13 : uses < 128 ? 14 : uses < 512 ? 15 : 16;
    if (uses < 512) ++uses;
    for (std::size_t i = 0; i < kInputs; ++i) {
      const std::int32_t weight = weights[i] + ((inputs[i] * error + (1 << (shift - 1))) >> shift);
      weights[i] = std::clamp(weight, -131071, 131071);
    }
  }
};

// Symbols made of the same few decisions in many contexts.
class Model {
 public:
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

  // The chance of a 1, in 1/65536.
  int chance(const Context& context, std::size_t decision) const {
    std::array<std::int32_t, kInputs> inputs;
    return mixed(context, decision, inputs);
  }

  template <class Side>
  bool code(Side& side, const Context& context, std::size_t decision, bool one) {
    std::array<std::int32_t, kInputs> inputs;
    const int chance = mixed(context, decision, inputs);
    one = side.chance(static_cast<std::uint32_t>(65536 - chance), one);
    const int error = (one ? 65536 : 0) - chance;
    first_[index(context.first_set, decision)].learn(inputs, error);
    second_[index(context.second_set, decision)].learn(inputs, error);
    for (std::size_t i = 0; i < kContexts; ++i) {
      tables_[i][index(context.at[i], decision)].learn(one, 255);
    }
    return one;
  }

 private:
  std::size_t index(std::int32_t place, std::size_t decision) const {
    return static_cast<std::size_t>(place) * decisions_ + decision;
  }

  int mixed(const Context& context, std::size_t decision,
            std::array<std::int32_t, kInputs>& inputs) const {
    const Logistic& tables = logistic();
    for (std::size_t i = 0; i < kContexts; ++i) {
      const Counter& counter = tables_[i][index(context.at[i], decision)];
      inputs[2 * i] = tables.logit(counter.slow);
      inputs[2 * i + 1] = tables.logit(counter.fast);
    }
    const int first = first_[index(context.first_set, decision)].mixed(inputs);
    const int second = second_[index(context.second_set, decision)].mixed(inputs);
    return tables.chance((first + second) >> 1);
  }

  std::size_t decisions_;
  std::array<std::vector<Counter>, kContexts> tables_;
  std::vector<Mixer> first_, second_;
};

// Magnitudes: is it more than 0, than 1, ... than 13; then the length of what is above, and that.
inline constexpr int kUnary = 14;
inline constexpr int kMostLength = 29;
inline constexpr std::size_t kMagnitudeDecisions = kUnary + 18;

template <class Side>
std::int64_t code_magnitude(Model& model, Side& side, const Context& context, std::int64_t value) {
  for (int u = 0; u < kUnary; ++u) {
    if (!model.code(side, context, static_cast<std::size_t>(u), value > u)) return u;
  }
  const std::int64_t above = value - kUnary + 1;
  int length = 0;
  while (length < kMostLength &&
         model.code(side, context,
                    std::size_t{kUnary} + static_cast<std::size_t>(std::min(length, 17)),
                    above >> (length + 1) > 0)) {
    ++length;
  }
  const std::int64_t top = std::int64_t{1} << length;
  const auto below = side.raw(length, static_cast<std::uint64_t>(above & (top - 1)));
  return kUnary - 1 + top + static_cast<std::int64_t>(below);
}

}  // namespace mocapress::near
