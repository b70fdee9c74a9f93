#include "near_encoding/encoder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "coding/sides.hpp"
#include "near/codec.hpp"
#include "near/coder.hpp"
#include "near/marks.hpp"
#include "near/prediction.hpp"
#include "near/start.hpp"
#include "near_encoding/search.hpp"

namespace mocapress::near {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Numbers beyond so many steps are kept as they are.
constexpr double kMostSteps = 1e8;

class Encoding {
 public:
  Encoding(const double* values, std::size_t frames, const Task& task, const Measure& measure,
           const Measure& curves)
      : given_(values),
        frames_(frames),
        channels_(task.plan.steps.size()),
        task_(task),
        measure_(curves),
        file_measure_(measure),
        whole_(values, values + frames * channels_),
        raised_(frames * channels_, 1.0F),
        moves_(channels_),
        steps_(task.plan.steps) {
    fill_gaps();
    wanted_ = turned(whole_, task.plan);
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const std::size_t c = i % channels_;
      moves_[c] = moves_[c] || wanted_[i] != wanted_[c];
    }
    weigh();
  }

  // Codes the curves once and gives what was learned.
  Models learn() {
    curves();
    return coder_;
  }

  Coded run() {
    Coded coded;
    std::vector<Kept> kept;
    // Costlier errors may cost more than corrections: the smallest payload stays.
    for (int round = 0;; ++round) {
      curves();
      const std::vector<double> drawn = drawn_;
      const auto corrections = correct();
      turn_back(drawn_.data(), frames_, task_.plan, starts_);
      auto own = keep();
      Marks marks(side_, frames_, channels_);
      marks.corrections(corrections, [](const Correction&) {});
      marks.kept(own, [](std::size_t, std::size_t, double) {});
      Bytes payload = side_.finish();
      if (round == 0 || payload.size() < coded.payload.size()) {
        coded.payload = std::move(payload);
        kept = std::move(own);
      }
      drawn_ = drawn;
      if (round == task_.rounds || !raise(round)) break;
    }
    coded.values.resize(frames_ * channels_);
    decode(coded.payload, coded.values.data(), frames_, task_.plan);
    const std::size_t points = file_measure_.points(channels_);
    coded.errors.resize(frames_ * points);
    drawn_ = coded.values;
    for (const Kept& one : kept) {
      for (std::size_t k = 0; k < one.bits.size(); ++k) {
        const std::size_t at = (one.first + k) * channels_ + one.channel;
        drawn_[at] = whole_[at];
      }
    }
    for (std::size_t f = 0; f < frames_; ++f) {
      file_measure_.errors(&whole_[f * channels_], &drawn_[f * channels_], channels_,
                           &coded.errors[f * points]);
    }
    return coded;
  }

 private:
  // Whether the curves follow a number; otherwise it comes back as it is.
  bool is_usable(std::size_t i) const {
    if (!task_.kept.empty() && task_.kept[i]) return false;
    return std::fabs(given_[i]) <= kMostSteps * steps_[i % channels_];
  }

  // Puts a number for the curves wherever they follow none: on a line between those around.
  void fill_gaps() {
    for (std::size_t c = 0; c < channels_; ++c) {
      std::size_t next = 0;  // frame behind those that are filled
      double last = 0;
      for (std::size_t f = 0; f <= frames_; ++f) {
        if (f < frames_ && !is_usable(f * channels_ + c)) continue;
        const double own = f < frames_ ? whole_[f * channels_ + c] : last;
        const double from = next > 0 ? last : own;
        for (std::size_t k = next; k < f; ++k) {
          const auto part = static_cast<double>(k + 1 - next) / static_cast<double>(f + 1 - next);
          whole_[k * channels_ + c] = from + (own - from) * part;
        }
        next = f + 1;
        last = own;
      }
    }
  }

  void weigh() {
    Leverage leverage(measure_, channels_, task_.weights, moves_);
    costs_.resize(frames_ * channels_);
    shares_.resize(frames_ * leverage.pairs());
    for (std::size_t f = 0; f < frames_; ++f) {
      leverage.of_frame(&wanted_[f * channels_], &costs_[f * channels_],
                        shares_.data() + f * leverage.pairs());
    }
    pairs_ = leverage.pairs();
    for (std::size_t c = 0; c < channels_; ++c) {
      const auto before = leverage.before(c);
      before_.emplace_back(before.begin(), before.end());
      begins_.push_back(leverage.begin_of(c));
    }
  }

  // Codes the curves of all channels; `drawn_` is what they give.
  void curves() {
    side_ = RangeWriting();
    coder_ = task_.plan.start != nullptr ? Coder(task_.plan.start->models) : Coder();
    drawn_.assign(frames_ * channels_, 0.0);
    begin();
    int length = 0;
    for (std::size_t first = 0; first < frames_; first += static_cast<std::size_t>(length)) {
      length = span_of(task_.plan.early, first, frames_ - first);
      const std::size_t count =
          std::min<std::size_t>(static_cast<std::size_t>(length), frames_ - first);
      prediction_.begin_span(length);
      for (std::size_t i = 0; i < coder_.channels.size(); ++i) span(i, first, length, count);
      if (first + count < frames_) prediction_.end_span(count);
    }
    // What is kept anyway has no error that others may make good.
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
      if (is_replaced(i)) drawn_[i] = wanted_[i];
    }
  }

  // Whether the curves have another number in place of what was given.
  bool is_replaced(std::size_t i) const { return !is_usable(i); }

  void begin() {
    Bit moves[2];
    Difference<6> firsts;
    bool moved = true;
    for (std::size_t c = 0; c < channels_; ++c) {
      moved = side_.bit(moves[moved ? 1 : 0], moves_[c]);
      const double unit = steps_[c] * (moved ? task_.plan.knot : 0.25);
      const double first = task_.plan.first_of(c);
      const auto number = std::llround((wanted_[c] - first) / unit);
      firsts.code(side_, number);
      const double value = first + static_cast<double>(number) * unit;
      if (moved) {
        Channel& channel = coder_.channels.emplace_back();
        channel.index = c;
        channel.last = value;
      } else {
        for (std::size_t f = 0; f < frames_; ++f) drawn_[f * channels_ + c] = value;
      }
    }
    std::vector<Angles> starts;
    for (const Turning& turning : task_.plan.turnings) {
      const double* const own = whole_.data() + turning.first;
      starts.push_back({own[0], own[1], own[2]});
    }
    starts_ = code_starts(side_, task_.plan, starts);
    prediction_ = prediction_of(coder_, task_.plan);
  }

  void span(std::size_t i, std::size_t first, int length, std::size_t count) {
    Channel& channel = coder_.channels[i];
    channel.begin_span(length);
    const std::size_t c = channel.index;
    const auto n = static_cast<std::size_t>(length);
    std::array<double, kLongest> predicted, values, costs;
    prediction_.predict(i, predicted.data());
    for (std::size_t f = 0; f < n; ++f) {
      if (f >= count) {
        values[f] = values[f - 1];
        costs[f] = 0;
        continue;
      }
      const std::size_t at = (first + f) * channels_;
      const float* share = shares_.data() + (first + f) * pairs_ + begins_[c];
      double value = wanted_[at + c];
      for (const std::size_t other : before_[c]) {
        value -= *share++ * (drawn_[at + other] - wanted_[at + other]);
      }
      values[f] = value - predicted[f];
      costs[f] = costs_[at + c] * raised_[at + c];
    }
    const double bit_cost = task_.rate * task_.scale * task_.scale;
    const Target target{values.data(), costs.data(), steps_[c], bit_cost, task_.tries_knots};
    const Cut cut = search(coder_, i, task_.plan, target, length, channel.last);
    std::size_t next = 0;
    write(i, cut, next, 0, length);
    for (std::size_t f = 0; f < n; ++f) values[f] = cut.curve[f] + predicted[f];
    prediction_.tell(i, values.data(), cut.curve.data());
    for (std::size_t f = 0; f < count; ++f) drawn_[(first + f) * channels_ + c] = values[f];
    channel.last = values[n - 1];
  }

  void write(std::size_t i, const Cut& cut, std::size_t& next, int start, int length) {
    Channel& channel = coder_.channels[i];
    const Block* const before = channel.blocks.empty() ? nullptr : &channel.blocks.back();
    const Around around = coder_.around(i, before, start, length);
    const bool is_split = cut.pieces[next].block.length < length;
    if (length > kShortest && coder_.split<Narrow>(side_, around, length, is_split)) {
      write(i, cut, next, start, length / 2);
      write(i, cut, next, start + length / 2, length / 2);
      return;
    }
    Block block = cut.pieces[next++].block;
    coder_.code<Narrow>(side_, i, around, block);
    channel.blocks.push_back(block);
  }

  // The largest error of a point, without a rig of a value.
  double bound_of(std::size_t point) const {
    if (measure_.rig) return task_.most[point];
    return std::min(task_.most[point], task_.value_most[point] * measure_.others[point]);
  }

  bool within(const double* errors) const {
    const std::size_t count = measure_.points(channels_);
    for (std::size_t p = 0; p < count; ++p) {
      if (!(errors[p] <= bound_of(p))) return false;
    }
    return true;
  }

  // By how much each point of each frame is beyond its bound, as a ratio; whether any is.
  template <class Each>
  bool beyond(const Measure& measure, const std::vector<double>& wanted, Each&& each) const {
    std::vector<double> errors(measure.points(channels_));
    bool any = false;
    for (std::size_t f = 0; f < frames_; ++f) {
      measure.errors(&wanted[f * channels_], &drawn_[f * channels_], channels_, errors.data());
      for (std::size_t p = 0; p < errors.size(); ++p) {
        const double most = bound_of(p);
        if (errors[p] <= most) continue;
        any = true;
        each(f, p, errors[p] / most);
      }
    }
    return any;
  }

  // Makes errors costlier in channels that move what is beyond its bound, around its frame.
  bool raise(int round) {
    std::vector<float> times(raised_.size(), 1.0F);
    const auto costlier = [&](std::size_t frame, std::size_t point, double ratio) {
      const auto by = static_cast<float>(std::min(4.0, 1.6 * ratio * ratio));
      for (const std::size_t c : movers(point, round < 2 ? 3 : channels_)) {
        for (std::size_t f = frame - std::min<std::size_t>(frame, 3);
             f < std::min(frame + 4, frames_); ++f) {
          float& own = times[f * channels_ + c];
          own = std::max(own, by);
        }
      }
    };
    const bool any = beyond(measure_, wanted_, costlier);
    for (std::size_t i = 0; i < times.size(); ++i)
      raised_[i] = std::min(raised_[i] * times[i], 3e4F);
    return any;
  }

  // The channels that move a point, those of the nearest joints.
  std::vector<std::size_t> movers(std::size_t point, std::size_t joints) const {
    if (!measure_.rig) return {point};
    const Rig& rig = *measure_.rig;
    if (by_joint_.empty()) {
      by_joint_.resize(rig.joints());
      for (const auto& action : rig.actions()) by_joint_[action.joint].push_back(action.column);
    }
    std::vector<std::size_t> found;
    for (auto j = static_cast<std::int32_t>(point); j >= 0 && joints > 0;
         j = rig.parent(static_cast<std::size_t>(j))) {
      const auto& own = by_joint_[static_cast<std::size_t>(j)];
      found.insert(found.end(), own.begin(), own.end());
      if (!own.empty()) --joints;
    }
    return found;
  }

  // Of each frame that is beyond a bound, corrections that bring it back.
  std::vector<Correction> correct() {
    std::vector<std::vector<std::size_t>> points(frames_);
    beyond(measure_, wanted_,
           [&](std::size_t frame, std::size_t point, double) { points[frame].push_back(point); });
    std::vector<Correction> corrections;
    for (std::size_t f = 0; f < frames_; ++f) {
      if (points[f].empty()) continue;
      Correction best{f, 0, {}};
      double least = kInfinite;
      for (const std::size_t joints : {std::size_t{1}, std::size_t{2}, std::size_t{4}, channels_}) {
        std::vector<std::size_t> near;
        for (const std::size_t point : points[f]) {
          for (const std::size_t c : movers(point, joints)) near.push_back(c);
        }
        choose(near, best, least);
      }
      std::vector<std::size_t> all(channels_);
      std::iota(all.begin(), all.end(), std::size_t{0});
      if (best.added.empty()) choose(all, best, least);
      if (best.added.empty()) continue;
      for (const auto& [c, times] : best.added) {
        drawn_[f * channels_ + c] += times * part_of(steps_[c], best.fineness);
      }
      corrections.push_back(std::move(best));
    }
    return corrections;
  }

  // The coarsest correction of these channels that is enough, without what it can do without, if it
  // is cheaper than the least so far.
  void choose(std::vector<std::size_t> candidates, Correction& best, double& least) const {
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    for (int fineness = 0; fineness < 16; ++fineness) {
      Correction one{best.frame, fineness, {}};
      if (!moved_back(one, candidates)) continue;
      for (std::size_t k = one.added.size(); k-- > 0 && one.added.size() > 1;) {
        Correction fewer = one;
        fewer.added.erase(fewer.added.begin() + static_cast<std::ptrdiff_t>(k));
        if (is_enough(fewer)) one = std::move(fewer);
      }
      double bits = 8;
      for (const auto& [c, times] : one.added) bits += 6 + 2 * std::log2(std::abs(times));
      if (bits < least) {
        least = bits;
        best = std::move(one);
      }
      return;
    }
  }

  // Whether a frame is within its bound with a correction.
  bool is_enough(const Correction& one) const {
    std::vector<double> row(&drawn_[one.frame * channels_],
                            &drawn_[one.frame * channels_] + channels_);
    for (const auto& [c, times] : one.added) row[c] += times * part_of(steps_[c], one.fineness);
    std::vector<double> errors(measure_.points(channels_));
    measure_.errors(&wanted_[one.frame * channels_], row.data(), channels_, errors.data());
    return within(errors.data());
  }

  // Whether these channels, moved to the nearest part of a step, bring a frame within its bound.
  bool moved_back(Correction& one, const std::vector<std::size_t>& candidates) const {
    for (const std::size_t c : candidates) {
      const std::size_t at = one.frame * channels_ + c;
      const double times =
          std::round((wanted_[at] - drawn_[at]) / part_of(steps_[c], one.fineness));
      if (times == 0 || std::fabs(times) > 1e9) continue;
      one.added.emplace_back(c, static_cast<std::int32_t>(times));
    }
    return !one.added.empty() && is_enough(one);
  }

  // What is no number, and what is still beyond a bound.
  std::vector<Kept> keep() {
    std::vector<char> keeps(frames_ * channels_, 0);
    for (std::size_t i = 0; i < keeps.size(); ++i) {
      const double error = std::fabs(given_[i] - drawn_[i]);
      keeps[i] = is_replaced(i) || !(error <= task_.value_most[i % channels_]);
    }
    beyond(file_measure_, whole_, [&](std::size_t frame, std::size_t, double) {
      std::fill_n(&keeps[frame * channels_], channels_, 1);
    });
    std::vector<Kept> kept;
    for (std::size_t c = 0; c < channels_; ++c) {
      for (std::size_t f = 0; f < frames_; ++f) {
        if (keeps[f * channels_ + c] == 0) continue;
        const bool next = f > 0 && keeps[(f - 1) * channels_ + c] != 0;
        if (!next) kept.push_back({c, f, {}});
        kept.back().bits.push_back(std::bit_cast<std::uint64_t>(given_[f * channels_ + c]));
      }
    }
    return kept;
  }

  const double* given_;
  std::size_t frames_, channels_;
  const Task& task_;
  const Measure& measure_;       // of the curves
  const Measure& file_measure_;  // of the values
  std::vector<double> whole_;    // what is to be decoded, without gaps
  std::vector<double> wanted_;   // what the curves are to be
  std::vector<float> raised_;    // how much more errors cost
  std::vector<bool> moves_;
  const std::vector<double>& steps_;
  std::vector<double> costs_;
  std::vector<float> shares_;
  std::size_t pairs_ = 0;
  std::vector<std::vector<std::size_t>> before_;
  std::vector<std::size_t> begins_;
  RangeWriting side_;
  Coder coder_;
  Prediction prediction_;
  std::vector<double> drawn_;
  std::vector<Angles> starts_;
  mutable std::vector<std::vector<std::size_t>> by_joint_;
};

}  // namespace

Coded encode(const double* values, std::size_t frames, const Task& task, const Measure& measure,
             const Measure& curves) {
  return Encoding(values, frames, task, measure, curves).run();
}

void learn(Start& start, const double* values, std::size_t frames, Task task,
           const Measure& measure, const Measure& curves) {
  task.plan.start = &start;
  start.models = Encoding(values, frames, task, measure, curves).learn();
}

std::vector<double> turned(std::vector<double> values, const Plan& plan) {
  const std::size_t columns = plan.steps.size();
  for (const Turning& turning : plan.turnings) {
    Angles last{};
    for (std::size_t f = 0; f * columns < values.size(); ++f) {
      double* const own = &values[f * columns + turning.first];
      last = to_curves(turning, plan.radians, {own[0], own[1], own[2]}, last);
      std::copy_n(last.begin(), 3, own);
    }
  }
  return values;
}

}  // namespace mocapress::near
