#include "near_encoding/encoder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "coding/sides.hpp"
#include "near/codec.hpp"
#include "near/coder.hpp"
#include "near/marks.hpp"
#include "near/prediction.hpp"
#include "near/start.hpp"
#include "near_encoding/bounds.hpp"
#include "near_encoding/search.hpp"

namespace mocapress::near {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Numbers beyond so many steps are kept as they are.
constexpr double kMostSteps = 1e8;
// In units of columns; no motion has larger ones.
constexpr double kMostMotion = 1e9;

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
        moves_(channels_),
        turns_(channels_),
        steps_(task.plan.steps),
        bounds_(measure_, steps_, task.most, task.value_most) {
    for (const Turning& turning : task.plan.turnings) {
      for (std::size_t c = turning.first; c < turning.first + 3; ++c) turns_[c] = true;
    }
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
    curves();
    turn_back(drawn_.data(), frames_, task_.plan, starts_);
    // Errors are those of the figure as it stands with what is kept, if that is a motion at all.
    for (std::size_t i = 0; i < whole_.size(); ++i) {
      if (std::fabs(given_[i]) < kMostMotion) whole_[i] = given_[i];
    }
    const std::vector<Kept> kept = keep();
    Marks marks(side_, frames_, channels_);
    marks.corrections(corrections_, [](const Correction&) {});
    marks.kept(kept, [](std::size_t, std::size_t, double) {});
    coded.payload = side_.finish();
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
  // A way to code a span, and what stands behind it.
  struct Way {
    double cost = kInfinite;
    std::vector<Correction> mendings;
    Coder coder;
    RangeWriting side;
    Prediction prediction;
    std::vector<double> drawn;
  };

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
      length = span_of(task_.plan.short_spans, frames_ - first);
      const std::size_t count =
          std::min<std::size_t>(static_cast<std::size_t>(length), frames_ - first);
      bounded_span(first, length, count);
      if (first + count < frames_) prediction_.end_span(count);
    }
  }

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

  void whole_span(std::size_t first, int length, std::size_t count) {
    prediction_.begin_span(length);
    for (std::size_t i = 0; i < coder_.channels.size(); ++i) span(i, first, length, count);
    // What is kept anyway has no error that others may make good. Of a joint whose curves turn in
    // another order, a number that is kept is none of a curve.
    for (std::size_t i = first * channels_; i < (first + count) * channels_; ++i) {
      if (!turns_[i % channels_] && !is_usable(i)) drawn_[i] = wanted_[i];
    }
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
      costs[f] = costs_[at + c] * raised_[f * channels_ + c];
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

  // Codes a span, several times where errors are beyond their bounds: costlier errors may cost more
  // bits than corrections, so that the cheapest way stays.
  void bounded_span(std::size_t first, int length, std::size_t count) {
    raised_.assign(static_cast<std::size_t>(length) * channels_, 1.0F);
    if (!bounds_.any()) return whole_span(first, length, count);
    const Coder coder = coder_;
    const RangeWriting side = side_;
    Way best;
    for (int round = 0;; ++round) {
      whole_span(first, length, count);
      std::vector<Beyond> beyond;
      Way way = measured(first, count, beyond);
      const bool is_last = beyond.empty() || round == task_.rounds;
      const bool is_best = way.cost < best.cost;
      if (is_best && is_last) {
        best.mendings = std::move(way.mendings);
        break;
      }
      if (is_best) {
        best = std::move(way);
        best.coder = coder_;
        best.side = side_;
        best.prediction = prediction_;
        best.drawn.assign(&drawn_[first * channels_],
                          &drawn_[first * channels_] + count * channels_);
      }
      if (is_last) {
        coder_ = std::move(best.coder);
        side_ = std::move(best.side);
        prediction_ = std::move(best.prediction);
        std::copy(best.drawn.begin(), best.drawn.end(), &drawn_[first * channels_]);
        break;
      }
      raise(beyond, first, count, round);
      coder_ = coder;
      side_ = side;
    }
    for (Correction& one : best.mendings) {
      for (const auto& [c, times] : one.added) {
        drawn_[one.frame * channels_ + c] += times * part_of(steps_[c], one.fineness);
      }
      corrections_.push_back(std::move(one));
    }
  }

  // What a span costs as it was coded, in bits, with its corrections.
  Way measured(std::size_t first, std::size_t count, std::vector<Beyond>& beyond) const {
    Way way;
    std::vector<double> errors(task_.weights.size());
    double squares = 0;
    for (std::size_t f = first; f < first + count; ++f) {
      measure_.errors(&wanted_[f * channels_], &drawn_[f * channels_], channels_, errors.data());
      bounds_.add_beyond(f, errors.data(), beyond);
      for (std::size_t p = 0; p < errors.size(); ++p) {
        squares += task_.weights[p] * errors[p] * errors[p];
      }
    }
    way.cost = squares / (task_.rate * task_.scale * task_.scale) +
               8.0 * static_cast<double>(RangeWriting(side_).finish().size());
    std::vector<std::size_t> points;
    for (std::size_t i = 0; i < beyond.size(); ++i) {
      const std::size_t f = beyond[i].frame;
      points.push_back(beyond[i].point);
      if (i + 1 < beyond.size() && beyond[i + 1].frame == f) continue;
      Mending found = bounds_.mend(f, points, &wanted_[f * channels_], &drawn_[f * channels_]);
      points.clear();
      way.cost += std::min(found.bits, 64.0 * static_cast<double>(channels_));
      if (!found.correction.added.empty()) way.mendings.push_back(std::move(found.correction));
    }
    if (!(way.cost < kInfinite)) way.cost = std::numeric_limits<double>::max();
    return way;
  }

  // Makes errors costlier in channels that move what is beyond its bound, around its frame.
  void raise(const std::vector<Beyond>& beyond, std::size_t first, std::size_t count, int round) {
    std::vector<float> times(raised_.size(), 1.0F);
    for (const Beyond& one : beyond) {
      const auto by = static_cast<float>(std::min(4.0, 1.6 * one.ratio * one.ratio));
      const std::size_t own = one.frame - first;
      for (const std::size_t c : bounds_.movers({one.point}, round < 2 ? 3 : task_.most.size())) {
        for (std::size_t f = own - std::min<std::size_t>(own, 3); f < std::min(own + 4, count);
             ++f) {
          float& most = times[f * channels_ + c];
          most = std::max(most, by);
        }
      }
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
      raised_[i] = std::min(raised_[i] * times[i], 3e4F);
    }
  }

  // What is no number, and what is still beyond a bound.
  std::vector<Kept> keep() {
    std::vector<char> keeps(frames_ * channels_, 0);
    for (std::size_t i = 0; i < keeps.size(); ++i) {
      const double error = std::fabs(given_[i] - drawn_[i]);
      keeps[i] = !is_usable(i) || !(error <= task_.value_most[i % channels_]);
      if (keeps[i] != 0) drawn_[i] = whole_[i];  // what others made good of it goes with its error
    }
    std::vector<double> errors(task_.most.size());
    for (std::size_t f = 0; f < frames_ && bounds_.any(); ++f) {
      std::vector<Beyond> beyond;
      file_measure_.errors(&whole_[f * channels_], &drawn_[f * channels_], channels_,
                           errors.data());
      bounds_.add_beyond(f, errors.data(), beyond);
      if (!beyond.empty()) std::fill_n(&keeps[f * channels_], channels_, 1);
    }
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
  std::vector<float> raised_;    // how much more errors cost in a span
  std::vector<bool> moves_, turns_;
  const std::vector<double>& steps_;
  Bounds bounds_;
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
  std::vector<Correction> corrections_;
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
