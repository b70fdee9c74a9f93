// The model of one clip, or of a part of its columns: what is known of the frames so far, and how
// the next one is coded with it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "coding/sides.hpp"
#include "exact/blend.hpp"
#include "exact/channel.hpp"
#include "exact/codec.hpp"
#include "exact/expert.hpp"
#include "exact/kinematics.hpp"
#include "exact/last.hpp"
#include "exact/lawful.hpp"
#include "exact/limbs.hpp"
#include "exact/network.hpp"
#include "exact/noise.hpp"
#include "exact/own.hpp"
#include "exact/plan.hpp"
#include "exact/residual.hpp"
#include "exact/spread.hpp"

namespace mocapress::exact {

inline constexpr double kFloor = 0.1;  // in steps: as close as a prediction can be expected to come
inline constexpr double kFarthest = 20;         // in scales: an error beyond counts as that
inline constexpr double kRounding = 0.15;       // in steps: what rounding adds to the scale
inline constexpr std::uint32_t kNoCut = 65512;  // its chance, in 1/65536
// The first levels that have them.
inline constexpr int kNetworkFrom = 7, kTunedFrom = kStrongest;

class Model {
 public:
  explicit Model(const Clip& clip)
      : noise_(clip.columns),
        count_(noise_.first()),
        own_(count_),
        frames_(count_),
        spreads_(count_),
        residual_(count_) {
    const auto columns = clip.columns;
    const auto known = columns.first(count_);
    if (knows_skeleton(known, clip.level)) kinematics_.emplace(known);
    Plans plan = plans(known, clip.couplings, clip.level);
    for (auto& expert : plan.experts) experts_.emplace_back(std::move(expert), count_);
    for (const auto& limbs : plan.limbs) limbs_.emplace_back(limbs, count_);
    for (std::size_t c = 0; c < count_; ++c) {
      const NumberLine line(columns[c].line, columns[c].digits);
      std::vector<Predictor> predictors;
      std::vector<std::size_t> slots;
      for (const Predictor some : plan.order) {
        if (!predicts(some, c)) continue;
        predictors.push_back(some);
        slots.push_back(slot(some));
      }
      const double unit = std::ldexp(1.0, columns[c].exponent);
      channels_.push_back({line, unit, 1 / unit, 1 / static_cast<double>(predictors.size()),
                           predictors, slots, turns_of(columns[c]), nullptr});
    }
    for (const Coupling& coupling : clip.couplings) {
      if (coupling.kind == 0) continue;
      laws_.push_back(std::make_unique<Lawful>(coupling, columns));
      for (const auto target : coupling.targets) channels_[target].law = laws_.back().get();
    }
    last_ = std::make_unique<LastStage>(count_, slots());
    if (clip.level >= kNetworkFrom) network_.emplace(count_, clip.level >= kTunedFrom);
    gather_blends(blend_plan(kinematics_.has_value(), clip.level));
    // Longer chains come first, so that those that learn together are of one length.
    for (auto& expert : experts_) learners_.push_back(&expert);
    std::ranges::stable_sort(learners_, std::greater(),
                             [](Expert* e) { return e->chain().size(); });
    for (auto* expert : learners_) chains_.push_back(&expert->chain());
    // Those of the predictors, of a law, and the blend.
    predictions_.resize(plan.order.size() + Lawful::kPredictions + 1);
    begin_with(clip.start);
  }

  // What the network sees is added to `seen`, and behind each its target.
  void show_network(std::vector<float>* seen) { seen_ = seen; }

  Start learned() {
    Start start;
    visit_shared([&](auto& value) { start.shared.push_back(kept(value)); });
    for (std::size_t c = 0; c < channels_.size() + noise_.size(); ++c) {
      std::vector<float> column;
      visit_column(c, [&](auto& value) { column.push_back(kept(value)); });
      start.columns.push_back(std::move(column));
    }
    return start;
  }

  // `cut`: whether the motion begins anew, and tells nothing of how it goes on.
  template <class Side>
  void code_frame(Side& side, double* row, bool cut) {
    noise_.code(side, row);
    frames_.next();
    if (first_ || side.chance(kNoCut, cut)) return code_first_frame(side, row);
    for (auto& expert : experts_) expert.begin();
    for (auto& limbs : limbs_) limbs.begin();
    own_.begin(frames_);
    spreads_.begin();
    last_->begin();
    if (network_) network_->begin();
    if (kinematics_) kinematics_->begin(frames_);
    for (std::size_t c = 0; c < count_; ++c) row[c] = code_number(side, c, row[c]);
    weights_.clear();
    for (auto* expert : learners_) weights_.push_back(expert->weigh(frames_));
    Chain::learn_all(chains_, weights_);
    for (auto& limbs : limbs_) limbs.learn(frames_);
    own_.learn(frames_);
    for (auto& blends : blends_) blends.learn();
    last_->learn();
    spreads_.learn();
  }

 private:
  template <class Visit>
  void visit_shared(Visit&& each) {
    residual_.visit(each);
  }

  template <class Visit>
  void visit_column(std::size_t c, Visit&& each) {
    if (c >= count_) return noise_.visit(c, each);
    spreads_.visit(c, each);
    channels_[c].blends->visit(channels_[c].blend, each);
    if (channels_[c].law != nullptr) channels_[c].choice.visit(each);
  }

  void begin_with(const Start& start) {
    std::size_t size = 0;
    visit_shared([&](auto&) { ++size; });
    if (start.shared.size() == size) {
      const float* next = start.shared.data();
      visit_shared([&](auto& value) { take(value, *next++); });
      residual_.share_shape();
    }
    for (std::size_t c = 0; c < std::min(start.columns.size(), count_ + noise_.size()); ++c) {
      size = 0;
      visit_column(c, [&](auto&) { ++size; });
      if (start.columns[c].size() != size) continue;
      const float* next = start.columns[c].data();
      visit_column(c, [&](auto& value) { take(value, *next++); });
    }
  }

  // Channels with equally many predictors are blended together.
  void gather_blends(const Blends::Plan& plan) {
    std::map<std::size_t, std::size_t> counts;
    for (auto& channel : channels_) {
      const std::size_t usual = channel.predictors.size();
      const bool sure = channel.law != nullptr && channel.law->sure();
      channel.from = sure ? usual : 0;
      channel.to = sure ? usual + 1 : usual;
      channel.blend = counts[count_predictors(channel)]++;
    }
    blends_.reserve(counts.size());
    for (const auto& [count, channels] : counts) {
      blends_.emplace_back(channels, count, plan);
      for (auto& channel : channels_) {
        if (count_predictors(channel) == count) channel.blends = &blends_.back();
      }
    }
  }

  // Which predictors there are, without those that have no slot.
  std::vector<std::size_t> slots() const {
    std::set<std::size_t> found;
    for (const Channel& channel : channels_) {
      found.insert(channel.slots.begin(), channel.slots.end());
    }
    found.erase(kNoSlot);
    return {found.begin(), found.end()};
  }

  bool predicts(Predictor some, std::size_t c) const {
    return some.kind != Predictor::Kind::expert || experts_[some.index].predicts(c);
  }

  std::size_t slot(Predictor some) const {
    switch (some.kind) {
      case Predictor::Kind::expert:
        return experts_[some.index].slot();
      case Predictor::Kind::limbs:
        return limbs_[some.index].slot();
      default:
        return kOwnSlot;
    }
  }

  // How far a predictor has a channel move since the last frame.
  double move(Predictor some, std::size_t c) {
    switch (some.kind) {
      case Predictor::Kind::expert:
        return experts_[some.index].predict(c, frames_) - frames_.level(c, 1);
      case Predictor::Kind::limbs:
        return limbs_[some.index].predict(c, frames_) - frames_.level(c, 1);
      default:
        return own_.move(c);
    }
  }

  static std::size_t count_predictors(const Channel& channel) {
    return channel.predictors.size() + (channel.law != nullptr ? Lawful::kPredictions : 0);
  }

  static std::optional<Turns> turns_of(const Column& column) {
    if (column.turns == 0) return std::nullopt;
    return Turns(column.turns == 1 ? -180 : 0);
  }

  template <class Side>
  void code_first_frame(Side& side, double* row) {
    for (std::size_t c = 0; c < count_; ++c) {
      row[c] = residual_.code_first(side, channels_[c].line, row[c]);
      for (std::size_t age = 0; age < Frames::kKept; ++age) {
        frames_.next();
        frames_.set(c, level(c, row[c]));
      }
    }
    first_ = false;
  }

  template <class Side>
  double code_number(Side& side, std::size_t c, double number) {
    Channel& channel = channels_[c];
    if (kinematics_) frames_.set_guess(c, sane(kinematics_->guess(c, frames_)));
    const std::size_t count = channel.predictors.size();
    for (std::size_t i = 0; i < count; ++i) predictions_[i] = move(channel.predictors[i], c);
    if (channel.law != nullptr) {
      channel.law->predict(c, frames_.row(0).data(), frames_.row(1).data(),
                           predictions_.data() + count);
    }
    double blended = channel.blends->predict(channel.blend, predictions_, channel.from, channel.to);
    const bool unsure = channel.law != nullptr && !channel.law->sure();
    if (unsure) {
      predictions_[count + Lawful::kPredictions] = blended;
      blended = predictions_[count + channel.choice.nearest()];
    }
    const double expected = sane(frames_.level(c, 1) + blended) * channel.per_unit;
    double turned = channel.turns ? channel.turns->left(expected) : 0;
    Beside beside = beside_blend(c, blended, channel.line.step(expected - turned) * channel.unit);
    const double span = beside.scale + beside.step;
    if (beside.last) add_last_stage(c, beside, span);
    const double moved = blended + beside.moved;
    const double predicted =
        sane(frames_.level(c, 1) + (moved + beside.moved_again)) * channel.per_unit;
    const double wide = beside.scale + kRounding * beside.step;
    const double width = wide * channel.per_unit;
    if (channel.turns) turned = channel.turns->code(side, predicted, width, number);
    const double coded = residual_.code(side, c, channel.line, predicted - turned, width, number);
    const double before = frames_.level(c, 1) * channel.per_unit;
    const double now = level(c, channel.turns ? coded + Turns::since(before, coded) : coded);
    const double error = now - frames_.level(c, 1);
    channel.blends->see(channel.blend, error, span);
    if (unsure) {
      channel.choice.learn(predictions_.data() + count, error, kFarthest * span);
    }
    if (beside.last) beside.last->see(c, error - blended);
    if (network_) {
      if (beside.last && seen_ != nullptr) network_->show((error - moved) / span, *seen_);
      if (beside.last) network_->learn((error - (moved + beside.moved_again)) / wide);
      network_->see(c, (error - blended) / span, span);
    }
    spreads_.see(c, (error - moved) / beside.loose);
    frames_.set(c, now);
    return coded;
  }

  // What a number is coded with beside the blend of its predictions, in levels.
  struct Beside {
    LastStage* last;  // where the last stage moves the blend
    double step;      // of the line
    double loose;     // how many times further off a law may be
    double scale;
    double moved = 0;        // by the last stage
    double moved_again = 0;  // by the network
    LastStage::Apart apart{};
  };

  Beside beside_blend(std::size_t c, double blended, double step) {
    const Channel& channel = channels_[c];
    const bool sure = channel.law != nullptr && channel.law->sure();
    const double loose = channel.law != nullptr ? channel.law->looseness() : 1;
    Beside beside{channel.law == nullptr ? last_.get() : nullptr, step, loose, 0};
    double sum = 0;
    for (std::size_t i = 0; i < channel.predictors.size(); ++i) {
      const double far = predictions_[i] - blended;
      beside.apart[channel.slots[i]] = far;
      sum += std::fabs(far);
    }
    if (beside.last) beside.moved = beside.last->move(c, beside.apart);
    // How far the predictors are from what was made of them; where a law is sure, how far rounding
    // may have led it astray.
    const double doubt = sure ? loose * step : sum * channel.share;
    beside.scale = loose * spreads_.scale(c, doubt / loose, (kFloor * step + kTiny) / loose);
    return beside;
  }

  void add_last_stage(std::size_t c, Beside& beside, double span) {
    beside.moved += beside.last->move_by_past(c, span);
    if (!network_) return;
    Network::Known known;
    for (std::size_t i = 0; i < LastStage::kPast; ++i)
      known.residuals[i] = beside.last->residual(c, i);
    known.apart = beside.apart;
    known.moved = beside.moved;
    known.last_move = frames_.difference(c, 1, 1);
    known.scale = beside.scale;
    known.step = beside.step;
    known.spread = spreads_.features(c);
    const Network::Told told = network_->tell(c, known);
    beside.moved_again = told.move * span;
    beside.scale *= told.scale;
  }

  static constexpr double kTiny = 1e-9;

  double level(std::size_t c, double number) const {
    const double level = number * channels_[c].unit;
    return level == level ? sane(level) : 0;
  }

  NoiseColumns noise_;
  std::size_t count_;  // columns that are predicted
  std::vector<Expert> experts_;
  std::vector<Limbs> limbs_;
  OwnChains own_;
  std::vector<Channel> channels_;
  std::vector<std::unique_ptr<Lawful>> laws_;
  std::optional<Kinematics> kinematics_;
  std::vector<Blends> blends_;
  Frames frames_;
  std::unique_ptr<LastStage> last_;
  std::optional<Network> network_;
  Spreads spreads_;
  Residual residual_;
  std::vector<double> predictions_;
  std::vector<Expert*> learners_;
  std::vector<Chain*> chains_;
  std::vector<double> weights_;
  std::vector<float>* seen_ = nullptr;
  bool first_ = true;
};

}  // namespace mocapress::exact
