#include "near/start.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "coding/numbers.hpp"
#include "coding/sides.hpp"

namespace mocapress::near {
namespace {

constexpr std::uint8_t kFine[] = {
#include "near/data/start_fine_1.txt"
};
constexpr std::uint8_t kMiddling[] = {
#include "near/data/start_middling_1.txt"
};
constexpr std::uint8_t kCoarse[] = {
#include "near/data/start_coarse_1.txt"
};
constexpr double kFigure[] = {
#include "near/data/figure_1.txt"
};

// Chances and weights to some digits, in both directions.
class Notes {
 public:
  // `last`: whether the decision before this one was met; gives whether this was.
  template <class Side>
  bool counter(Side& side, Counter& counter, bool last) {
    const bool known = side.bit(known_[last ? 1 : 0], counter.count > 1);
    if (!known) return false;
    const int logit = logistic().logit(counter.slow());
    const auto place = chances_.code(side, static_cast<unsigned>(logit + 1024) >> 5);
    const auto met = static_cast<unsigned>(std::bit_width(unsigned{counter.count})) - 1;
    const auto times = counts_.code(side, std::min(met, 5U));
    if constexpr (Side::kReading) {
      const int chance = logistic().chance(static_cast<int>(place << 5) - 1008);
      const auto both = static_cast<std::uint32_t>(std::clamp(chance, 64, 65471));
      counter = {both << 16 | both, 1U << times};
    }
    return true;
  }

  template <class Side>
  void mixer(Side& side, Mixer& mixer) {
    const auto uses = uses_.code(side, static_cast<unsigned>(std::bit_width(unsigned(mixer.uses))));
    if (uses == 0) return;
    if constexpr (Side::kReading) mixer.uses = 1 << (uses - 1);
    // They are told by contexts, slow and fast in turn.
    for (std::size_t i = 0; i < kInputs; ++i) {
      std::int32_t& weight = mixer.weights[i % 2 * kContexts + i / 2];
      const auto part =
          weights_.code(side, static_cast<unsigned>(std::min((weight + 131584) >> 10, 255)));
      if constexpr (Side::kReading) weight = (static_cast<std::int32_t>(part) - 128) * 1024;
    }
  }

 private:
  Bit known_[2];
  BitTree<6> chances_;
  BitTree<3> counts_;
  BitTree<4> uses_;
  BitTree<8> weights_;
};

// Tables whose places go by channel, and the others.
constexpr unsigned kByChannel = 1U << 2, kSignsByChannel = 1U << 2 | 1U << 7;

template <class Side>
void code_models(Side& side, Notes& notes, Models& models, bool by_channel) {
  const auto code = [&](Model& model, unsigned own) {
    model.code_learned(side, notes, by_channel ? own : 255 & ~own, !by_channel);
  };
  code(models.knots, kByChannel);
  code(models.classes, kByChannel);
  code(models.sines, kByChannel);
  code(models.splits, kByChannel);
  code(models.signs, kSignsByChannel);
}

// Shares in 1/32, products as powers of 2^(1/4), and how far the features are the same in 1/64.
class AssumedNotes {
 public:
  template <class Side>
  void code(Side& side, std::vector<Assumed>& all) {
    std::uint64_t count = all.size();
    count = counts_.code(side, count);
    if constexpr (Side::kReading) all.resize(std::min<std::uint64_t>(count, 1 << 16));
    std::size_t channel = 0;
    for (Assumed& one : all) {
      const std::size_t further = gaps_.code(side, one.channel - channel);
      channel += further;
      if (further > 0) source_ = 0;
      source_ += places_.code(side, one.source - source_);
      one.channel = channel;
      one.source = source_;
      number(side, shares_[0], one.shares[0], 32);
      number(side, shares_[1], one.shares[1], 32);
      number(side, products_[0], one.moved, 1);
      number(side, products_[1], one.averaged, 1);
      number(side, both_, one.both, 64);
    }
  }

 private:
  template <class Side>
  static void number(Side& side, BitTree<8>& tree, double& value, double parts) {
    const double told = value * parts;
    const int whole = static_cast<int>(told + (told < 0 ? -0.5 : 0.5));
    const auto symbol = tree.code(side, static_cast<unsigned>(std::clamp(whole, -128, 127) + 128));
    value = (static_cast<int>(symbol) - 128) / parts;
  }

  std::size_t source_ = 0;
  Count counts_, gaps_, places_;
  BitTree<8> shares_[2], products_[2], both_;
};

template <class Side>
void code_start(Side& side, Start& start, bool known) {
  Notes notes;
  code_models(side, notes, start.models, false);
  if (!known) return;
  code_models(side, notes, start.models, true);
  AssumedNotes().code(side, start.assumed);
}

template <int kIndex, bool kKnown>
const Start& shipped() {
  static const Start kStart = [] {
    if constexpr (kIndex == 0) return unpack(kFine, kKnown);
    if constexpr (kIndex == 1) return unpack(kMiddling, kKnown);
    return unpack(kCoarse, kKnown);
  }();
  return kStart;
}

}  // namespace

const Start& start_of(int index, bool known) {
  if (index == 0) return known ? shipped<0, true>() : shipped<0, false>();
  if (index == 1) return known ? shipped<1, true>() : shipped<1, false>();
  return known ? shipped<2, true>() : shipped<2, false>();
}

const Figure& known_figure() {
  static const Figure kKnown = [] {
    Figure figure;
    const double* at = std::begin(kFigure);
    const auto whole = [&] { return static_cast<int>(*at++); };
    const int columns = whole();
    for (int c = 0; c < columns; ++c) {
      figure.exponents.push_back(whole());
      const int joint = whole(), parent = whole();
      figure.joints.of_column.push_back(joint);
      if (joint == static_cast<int>(figure.joints.parents.size())) {
        figure.joints.parents.push_back(parent);
      }
      figure.firsts.push_back(*at++);
    }
    const int turnings = whole();
    for (int t = 0; t < turnings; ++t) {
      Turning& turning = figure.turnings.emplace_back();
      turning.first = static_cast<std::size_t>(whole());
      for (auto* const order : {&turning.columns, &turning.axes, &turning.curves}) {
        *order = static_cast<std::uint8_t>(whole());
      }
    }
    return figure;
  }();
  return kKnown;
}

Bytes pack(Start& start) {
  RangeWriting side;
  code_start(side, start, true);
  return side.finish();
}

Start unpack(ByteView packed, bool known) {
  Start start;
  RangeReading side(packed);
  code_start(side, start, known);
  // Products were told as exponents.
  for (Assumed& one : start.assumed) {
    one.moved = step_of(16 * static_cast<int>(one.moved));
    one.averaged = step_of(16 * static_cast<int>(one.averaged));
    one.both = one.both * std::sqrt(one.moved * one.averaged);
  }
  return start;
}

}  // namespace mocapress::near
