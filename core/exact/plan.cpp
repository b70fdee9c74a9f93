#include "exact/plan.hpp"

#include <algorithm>
#include <utility>

#include "exact/tables.hpp"

namespace mocapress::exact {
namespace {

// More channels than these are cut into blocks, so that time grows with their number, not its
// square.
constexpr std::size_t kMostTogether = 72;

// How many channels are a block, and how many of the first ones belong to each.
struct Limbs {
  std::size_t block, root;
};
constexpr Limbs kFine = {6, 6};
constexpr Limbs kCoarse = {8, 0};

Variable past(std::size_t channel, int age) {
  return {Variable::Kind::past,
          {static_cast<std::uint16_t>(channel)},
          1,
          static_cast<std::uint8_t>(age)};
}

Variable one(Variable::Kind kind, std::size_t channel) {
  return {kind, {static_cast<std::uint16_t>(channel)}, 1, 0};
}

// Every channel by those before it in its block, and by the block's last frame.
void add_blocks(std::vector<ExpertPlan>& plans, std::size_t channels, double fading) {
  const std::size_t blocks = (channels + kMostTogether - 1) / kMostTogether;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t from = channels * block / blocks;
    const std::size_t to = channels * (block + 1) / blocks;
    ExpertPlan plan{kWholeSlot, 1, fading, {}};
    for (std::size_t channel = from; channel < to; ++channel) {
      plan.variables.push_back(past(channel, 1));
    }
    for (std::size_t channel = from; channel < to; ++channel) {
      plan.variables.push_back(one(Variable::Kind::target, channel));
    }
    plans.push_back(std::move(plan));
  }
}

// Every channel by those before it in its block, in the block before, and among the first ones, the
// root, which moves everything: few enough to be learned within a second.
void add_limbs(std::vector<ExpertPlan>& plans, std::size_t channels, const Limbs& limbs, int order,
               double fading) {
  for (std::size_t from = 0, last = 0; from < channels;) {
    const std::size_t to = std::min(channels, from + limbs.block);
    ExpertPlan plan{order == 1 ? kMoveSlot : kLimbSlot, order, fading, {}};
    for (std::size_t channel = 0; channel < from; ++channel) {
      if (channel < limbs.root || channel >= last) {
        plan.variables.push_back(one(Variable::Kind::known, channel));
      }
    }
    for (std::size_t channel = from; channel < to; ++channel) {
      plan.variables.push_back(one(Variable::Kind::target, channel));
    }
    plans.push_back(std::move(plan));
    last = from;
    from = to;
  }
}

// Every channel of the skeleton by its guess, and by guesses and channels before it in its limb.
void add_guessed(std::vector<ExpertPlan>& plans, std::span<const Column> columns, int history,
                 double fading) {
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
    plans.push_back(std::move(plan));
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

Plans plans(std::span<const Column> columns, std::span<const Coupling> couplings, int level) {
  const std::size_t channels = columns.size();
  std::vector<ExpertPlan> made;
  if (knows_skeleton(columns, level)) {
    add_guessed(made, columns, 0, 0.9);
    if (level >= 9) add_guessed(made, columns, 2, 0.98);
  } else {
    add_limbs(made, channels, level == 3 || level == 5 ? kCoarse : kFine, 2, 0.92);
  }
  const std::size_t before_own = level >= 5 ? made.size() : kNoOwn;
  if (level >= 9) {
    add_limbs(made, channels, kFine, 1, 0.94);
    add_blocks(made, channels, 0.998);
  }
  for (const auto& coupling : couplings) {
    if (coupling.kind == 0) made.push_back(coupled(coupling, 0.9998));
  }
  return {std::move(made), before_own};
}

}  // namespace mocapress::exact
