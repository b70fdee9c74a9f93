// The whole numbers of a frame, coded by either side of coding/sides.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/numbers.hpp"

namespace mocapress::qssd {

inline constexpr std::size_t kKinds = 18;  // of stages

// A bit whose chance of being 0 is counted, from a chance that it is taken to have at first.
class Counted {
 public:
  Counted() : Counted(128) {}
  explicit Counted(std::uint8_t chance) : zeros_(3 * (2 * std::uint32_t{chance} + 1)) {}

  template <class Side>
  bool code(Side& side, bool one) {
    const std::uint32_t chance = (zeros_ << 16) / all_;
    const bool coded = side.chance(std::clamp<std::uint32_t>(chance, 64, 65472), one);
    zeros_ += coded ? 0 : 64;
    all_ += 64;
    if (all_ > 64 * 400) {
      zeros_ /= 2;
      all_ /= 2;
    }
    return coded;
  }

 private:
  std::uint32_t zeros_;
  std::uint32_t all_ = 3 * 512;  // as after 24 bits
};

// Numbers of atoms and columns, each of which is mostly 0, in its own way in each kind of stage.
class Symbols {
 public:
  // `chances`: of a 0, in 1/256, for each kind and symbol; of kinds behind its last as of the last,
  // and where there are none, the usual ones.
  Symbols(std::size_t atoms, std::size_t columns, const std::vector<std::uint8_t>& chances)
      : atoms_(atoms), count_(atoms + columns), zeros_(kKinds * count_) {
    constexpr std::array<std::uint8_t, 4> kUsual = {40, 110, 170, 200};
    const std::size_t known = count_ == 0 ? 0 : chances.size() / count_;
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      for (std::size_t s = 0; s < count_; ++s) {
        const std::uint8_t chance = known > 0 ? chances[std::min(kind, known - 1) * count_ + s]
                                              : kUsual[std::min<std::size_t>(kind, 3)];
        zeros_[kind * count_ + s] = Counted(chance);
      }
    }
  }

  std::size_t count() const { return count_; }

  template <class Side>
  std::int64_t code(Side& side, std::size_t kind, std::size_t symbol, std::int64_t value) {
    if (!zeros_[kind * count_ + symbol].code(side, value != 0)) return 0;
    auto& more = more_[kind * 2 + (symbol < atoms_ ? 0 : 1)];
    const bool negative = side.raw(1, value < 0 ? 1 : 0) != 0;
    const std::int64_t magnitude = value < 0 ? -value : value;
    std::int64_t coded = 1;
    for (Counted& bit : more) {
      if (!bit.code(side, magnitude > coded)) return negative ? -coded : coded;
      ++coded;
    }
    const std::int64_t rest = rest_.code(side, magnitude - coded);
    if (rest < 0 || rest > kMostRest) {
      side.fail();
      return 0;
    }
    coded += rest;
    return negative ? -coded : coded;
  }

 private:
  static constexpr std::int64_t kMostRest = std::int64_t{1} << 50;

  std::size_t atoms_, count_;
  std::vector<Counted> zeros_;
  std::array<std::array<Counted, 14>, kKinds * 2> more_;
  Difference<6> rest_;
};

}  // namespace mocapress::qssd
