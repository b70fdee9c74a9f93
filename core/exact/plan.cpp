#include "exact/plan.hpp"

#include <algorithm>
#include <utility>

#include "exact/tables.hpp"

namespace mocapress::exact {
namespace {

// More channels than these are cut into blocks, so that time grows with their number, not its
// square.
constexpr std::size_t kMostTogether = 160;

Variable past(std::size_t channel, int age) {
  return {Variable::Kind::past,
          {static_cast<std::uint16_t>(channel)},
          1,
          static_cast<std::uint8_t>(age)};
}

Variable one(Variable::Kind kind, std::size_t channel) {
  return {kind, {static_cast<std::uint16_t>(channel)}, 1, 0};
}

// Every channel by those before it in its block; if `moves`, first differences, and those of the
// block's last frame, too.
void add_blocks(Plans& plans, std::size_t channels, bool moves, double fading) {
  const std::size_t blocks = (channels + kMostTogether - 1) / kMostTogether;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t from = channels * block / blocks;
    const std::size_t to = channels * (block + 1) / blocks;
    ExpertPlan plan{kWholeSlot, moves ? 1 : 2, fading, {}};
    for (std::size_t channel = from; moves && channel < to; ++channel) {
      plan.variables.push_back(past(channel, 1));
    }
    for (std::size_t channel = from; channel < to; ++channel) {
      plan.variables.push_back(one(Variable::Kind::target, channel));
    }
    plans.add(std::move(plan));
  }
}

// Every channel of the skeleton by its guess, and by guesses and channels before it in its limb.
void add_guessed(Plans& plans, std::span<const Column> columns, int history, double fading) {
  const auto limb = [&](std::size_t channel) {
    const int place = columns[channel].place;
    return place < 0 ? -1 : kCmu.channels[static_cast<std::size_t>(place)].limb;
  };
  for (std::size_t from = 0, to = 0; from < columns.size(); from = to) {
    while (to < columns.size() && limb(to) == limb(from)) ++to;
    if (limb(from) < 0) continue;
    ExpertPlan plan{history == 0 ? kLimbSlot : kGuessSlot, 2, fading, {}};
    for (int age = history; age >= 1; --age) {
      for (std::size_t channel = from; channel < to; ++channel) {
        plan.variables.push_back(past(channel, age));
      }
    }
    for (std::size_t channel = from; channel < to; ++channel) {
      plan.variables.push_back(one(Variable::Kind::guess, channel));
      plan.variables.push_back(one(Variable::Kind::target, channel));
    }
    plans.add(std::move(plan));
  }
}

// The targets by a polynomial of degree 3 of the sources.
ExpertPlan coupled(const Coupling& coupling, double fading) {
  ExpertPlan plan{kNoSlot, 1, fading, {}};
  for (const auto source : coupling.sources) {
    plan.variables.push_back(one(Variable::Kind::known, source));
  }
  const auto& s = coupling.sources;
  for (std::size_t i = 0; i < s.size(); ++i) {
    for (std::size_t j = i; j < s.size(); ++j) {
      plan.variables.push_back({Variable::Kind::product, {s[i], s[j]}, 2, 0});
      for (std::size_t k = j; k < s.size(); ++k) {
        plan.variables.push_back({Variable::Kind::product, {s[i], s[j], s[k]}, 3, 0});
      }
    }
  }
  for (const auto target : coupling.targets) {
    plan.variables.push_back(one(Variable::Kind::target, target));
  }
  return plan;
}

}  // namespace

bool knows_skeleton(std::span<const Column> columns, int level) {
  return level >= 8 &&
         std::ranges::any_of(columns, [](const Column& column) { return column.place >= 0; });
}

Blends::Plan blend_plan(bool known, int level) {
  static constexpr std::array kMemories = {0.94, 0.985, 0.998}, kStrong = {0.92, 0.985, 0.998};
  if (level < (known ? 9 : 8)) return kOneBlend;
  return level < kStrongest ? Blends::Plan{kMemories, 1} : Blends::Plan{kStrong, 10};
}

Plans plans(std::span<const Column> columns, std::span<const Coupling> couplings, int level) {
  const std::size_t channels = columns.size();
  Plans made;
  if (channels == 0) return made;
  const bool known = knows_skeleton(columns, level);
  if (known) {
    add_guessed(made, columns, 0, 0.9);
    if (level >= 9) add_guessed(made, columns, 2, 0.98);
  } else {
    made.add(LimbsPlan{kLimbSlot, 2, level == 6 ? 0.92 : 0.9});
    if (level >= 8) made.add(LimbsPlan{kGuessSlot, 2, 0.75});
  }
  made.order.push_back({Predictor::Kind::own});
  if (level >= (known ? 9 : 7)) made.add(LimbsPlan{kMoveSlot, 1, known ? 0.94 : 0.97});
  if (level >= (known ? 9 : 8)) add_blocks(made, channels, known, known ? 0.998 : 0.95);
  for (const auto& coupling : couplings) {
    if (coupling.kind == 0) made.add(coupled(coupling, 0.9998));
  }
  return made;
}

}  // namespace mocapress::exact
