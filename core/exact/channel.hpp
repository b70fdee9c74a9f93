// One channel of a model, and how what was learned of it is kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "exact/blend.hpp"
#include "exact/choice.hpp"
#include "exact/lawful.hpp"
#include "exact/plan.hpp"
#include "exact/turns.hpp"
#include "numbers/line.hpp"

namespace mocapress::exact {

// One channel: everything about it that the channels do not share.
struct Channel {
  NumberLine line;
  double unit;      // from numbers to levels
  double per_unit;  // and back
  double share;     // of each predictor in a mean
  std::vector<Predictor> predictors;
  std::vector<std::size_t> slots;  // of the predictors
  std::optional<Turns> turns;
  Lawful* law;  // or none
  Blends* blends = nullptr;
  std::size_t blend = 0;  // its place in `blends`
  std::size_t from = 0;   // what a blend trusts at first: the predictors from <= i < to
  std::size_t to = 0;
  Choice<Lawful::kPredictions + 1> choice{};  // of the law's predictions and the blend
};

// What was learned is kept as floats, chances in 24 bits.
inline float kept(double value) { return static_cast<float>(value); }
inline float kept(std::uint16_t value) { return value; }
inline float kept(std::uint32_t value) { return static_cast<float>(value >> 8); }

inline void take(double& value, float from) { value = from; }
inline void take(std::uint16_t& value, float from) {
  value = static_cast<std::uint16_t>(std::clamp(from, 15.0f, 65520.0f));
}
inline void take(std::uint32_t& value, float from) {
  value = static_cast<std::uint32_t>(std::clamp(from, 1.0f, 16777215.0f)) << 8;
}

}  // namespace mocapress::exact
