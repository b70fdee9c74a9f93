#include "near/codec.hpp"

#include <algorithm>

#include "coding/fail.hpp"
#include "coding/record.hpp"
#include "coding/sides.hpp"
#include "near/coder.hpp"
#include "near/marks.hpp"
#include "near/start.hpp"
#include "numbers/wide.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

constexpr int kMostExponent = 4096;

// Whether a part of a channel is cut into halves, and all of a block.
template <class Vector>
MOCAPRESS_IN_PLACE bool part_with(Coder& coder, RangeReading& side, std::size_t i,
                                  const Around& around, Block& block) {
  if (block.length > kShortest && coder.split<Vector>(side, around, block.length, false))
    return true;
  coder.code<Vector>(side, i, around, block);
  return false;
}

template <class Vector>
MOCAPRESS_WIDE MOCAPRESS_FLATTEN bool wide_part(Coder& coder, RangeReading& side, std::size_t i,
                                                const Around& around, Block& block) {
  return part_with<Vector>(coder, side, i, around, block);
}

MOCAPRESS_FLATTEN bool narrow_part(Coder& coder, RangeReading& side, std::size_t i,
                                   const Around& around, Block& block) {
  return part_with<Narrow>(coder, side, i, around, block);
}

bool read_part(Coder& coder, RangeReading& side, std::size_t i, const Around& around,
               Block& block) {
  if constexpr (kMayBeWide) {
    if (is_wide()) return wide_part<Wide>(coder, side, i, around, block);
  }
  return narrow_part(coder, side, i, around, block);
}

class Decoding {
 public:
  Decoding(ByteView payload, double* values, std::size_t frames, const Plan& plan)
      : side_(payload), values_(values), frames_(frames), plan_(plan) {}

  void run() {
    begin();
    int length = 0;
    for (std::size_t first = 0; first < frames_; first += static_cast<std::size_t>(length)) {
      length = span_of(plan_.short_spans, frames_ - first);
      const std::size_t count =
          std::min<std::size_t>(static_cast<std::size_t>(length), frames_ - first);
      prediction_.begin_span(length);
      for (std::size_t i = 0; i < coder_.channels.size(); ++i) span(i, first, length, count);
      if (first + count < frames_) prediction_.end_span(count);
    }
    Marks marks(side_, frames_, plan_.steps.size());
    marks.corrections({}, [&](const Correction& one) {
      for (const auto& [channel, times] : one.added) {
        at(one.frame, channel) += times * part_of(plan_.steps[channel], one.fineness);
      }
    });
    turn_back(values_, frames_, plan_, starts_);
    marks.kept({}, [&](std::size_t channel, std::size_t frame, double value) {
      at(frame, channel) = value;
    });
    if (!side_.exhausted()) fail("the payload is cut off, too long, or says what cannot be");
  }

 private:
  double& at(std::size_t frame, std::size_t channel) {
    return values_[frame * plan_.steps.size() + channel];
  }

  // Which channels move, and where each begins.
  void begin() {
    if (plan_.start != nullptr) coder_ = Coder(plan_.start->models);
    Bit moves[2];
    Difference<6> firsts;
    bool moved = true;
    for (std::size_t c = 0; c < plan_.steps.size(); ++c) {
      moved = side_.bit(moves[moved ? 1 : 0], false);
      const auto number = static_cast<double>(firsts.code(side_, 0));
      const double step = plan_.steps[c];
      if (moved) {
        Channel& channel = coder_.channels.emplace_back();
        channel.index = c;
        channel.last = plan_.first_of(c) + number * (step * plan_.knot);
      } else {
        const double value = plan_.first_of(c) + number * (step * 0.25);
        for (std::size_t f = 0; f < frames_; ++f) at(f, c) = value;
      }
      if (!side_.sound()) fail("the payload is cut off");
    }
    starts_ = code_starts(side_, plan_, {});
    prediction_ = prediction_of(coder_, plan_);
  }

  void span(std::size_t i, std::size_t first, int length, std::size_t count) {
    Channel& channel = coder_.channels[i];
    channel.begin_span(length);
    double last = channel.last;
    tree(i, 0, length, last);
    if (!side_.sound()) fail("the payload is cut off");
    std::array<double, kLongest> values;
    prediction_.predict(i, values.data());
    for (std::size_t f = 0; f < static_cast<std::size_t>(length); ++f) values[f] += curve_[f];
    prediction_.tell(i, values.data(), curve_.data());
    for (std::size_t f = 0; f < count; ++f) at(first + f, channel.index) = values[f];
    channel.last = values[static_cast<std::size_t>(length) - 1];
  }

  void tree(std::size_t i, int start, int length, double& last) {
    Channel& channel = coder_.channels[i];
    const Block* const before = channel.blocks.empty() ? nullptr : &channel.blocks.back();
    const Around around = coder_.around(i, before, start, length);
    Block block{start, length};
    if (read_part(coder_, side_, i, around, block)) {
      tree(i, start, length / 2, last);
      tree(i, start + length / 2, length / 2, last);
      return;
    }
    double* const curve = curve_.data() + start;
    draw(block, last, plan_.steps[channel.index], plan_, curve);
    last = curve[length - 1];
    channel.blocks.push_back(block);
  }

  RangeReading side_;
  double* values_;
  std::size_t frames_;
  const Plan& plan_;
  Coder coder_;
  Prediction prediction_;
  std::array<double, kLongest> curve_{};
  std::vector<Angles> starts_;
};

}  // namespace

Prediction prediction_of(const Coder& coder, const Plan& plan) {
  std::vector<std::size_t> columns;
  std::vector<double> steps, firsts;
  for (const Channel& channel : coder.channels) {
    columns.push_back(channel.index);
    steps.push_back(plan.steps[channel.index]);
    firsts.push_back(channel.last);
  }
  Prediction prediction(sources_of(plan.joints, columns), steps, firsts,
                        plan.short_spans ? kShortPace : kLongPace);
  if (plan.start != nullptr)
    prediction.assume(plan.start->assumed, plan.start->observations, columns);
  return prediction;
}

void turn_back(double* values, std::size_t frames, const Plan& plan,
               const std::vector<Angles>& starts) {
  for (std::size_t t = 0; t < plan.turnings.size(); ++t) {
    to_file(plan.turnings[t], plan.radians, values, plan.steps.size(), frames, starts[t]);
  }
}

namespace {

std::vector<std::int64_t> read_differences(ByteView bytes, std::size_t columns) {
  RangeReading side(bytes);
  std::vector<std::int64_t> apart(columns);
  code_differences(side, apart);
  if (!side.exhausted()) fail("differences of columns are cut off, too long, or cannot be");
  return apart;
}

// What a clip has finer, or coarser, than the known figure.
void make_finer(ByteView bytes, std::vector<std::int64_t>& exponents) {
  const std::vector<std::int64_t> apart = read_differences(bytes, exponents.size());
  std::int64_t finer = 0;
  for (std::size_t c = 0; c < apart.size(); ++c) {
    if (apart[c] < -kMostExponent || apart[c] > kMostExponent) fail("steps out of bounds");
    finer += apart[c];
    exponents[c] -= 32 * finer;
  }
}

// Which of the file's columns each is.
std::vector<std::size_t> read_order(ByteView bytes, std::size_t columns) {
  const auto count = static_cast<std::int64_t>(columns);
  std::vector<std::size_t> order;
  std::vector<bool> seen(columns);
  std::int64_t place = -1;
  for (const std::int64_t skipped : read_differences(bytes, columns)) {
    if (skipped < -count || skipped > count) fail("columns out of bounds");
    place += skipped + 1;
    if (place < 0 || place >= count || seen[static_cast<std::size_t>(place)]) {
      fail("columns in no order");
    }
    seen[static_cast<std::size_t>(place)] = true;
    order.push_back(static_cast<std::size_t>(place));
  }
  return order;
}

void put_in_order(double* values, std::size_t frames, const std::vector<std::size_t>& order) {
  std::vector<double> row(order.size());
  for (std::size_t f = 0; f < frames; ++f, values += row.size()) {
    for (std::size_t c = 0; c < row.size(); ++c) row[order[c]] = values[c];
    std::copy(row.begin(), row.end(), values);
  }
}

}  // namespace

Plan read_header(ByteView header, std::size_t columns) {
  Record record(header);
  Plan plan;
  record.numbers(2);  // how far the clip was found to be off: for readers, not for decoding
  const std::int64_t flags = record.integer(63);
  plan.short_spans = (flags & 2) == 0;
  plan.radians = (flags & 4) != 0;
  plan.knot = static_cast<double>(record.integer(63) + 1) / 8;
  const std::int64_t base = record.signed_integer();
  if (base < -kMostExponent || base > kMostExponent) fail("steps out of bounds");
  const auto start = static_cast<int>(record.integer(kStarts));
  const bool known = (flags & 8) != 0;
  if (start > 0) plan.start = &start_of(start - 1, known);
  const auto put_steps = [&](const auto& exponents) {
    for (const std::int64_t exponent : exponents) {
      if (exponent < -kMostExponent || exponent > kMostExponent) fail("steps out of bounds");
      plan.steps.push_back(step_of(static_cast<int>(exponent)));
    }
  };
  if (known) {
    if ((flags & 32) != 0) fail("the known figure in another order");
    const Figure& figure = known_figure();
    if (columns != figure.exponents.size()) fail("the known figure has other columns");
    const std::int64_t nearest = record.integer((1 << figure.turnings.size()) - 1);
    std::vector<std::int64_t> exponents(figure.exponents.begin(), figure.exponents.end());
    if ((flags & 16) != 0) make_finer(record.bytes(), exponents);
    record.end();
    plan.joints = figure.joints;
    plan.turnings = figure.turnings;
    plan.firsts = figure.firsts;
    for (std::size_t t = 0; t < plan.turnings.size(); ++t) {
      plan.turnings[t].nearest_to_zero = (nearest >> t & 1) != 0;
    }
    for (std::int64_t& each : exponents) each += base;
    put_steps(exponents);
    return plan;
  }
  if ((flags & 16) != 0) fail("steps of a figure that is not known");
  if ((flags & 32) != 0) plan.order = read_order(record.bytes(), columns);
  RangeReading side(record.bytes());
  record.end();
  std::vector<std::int64_t> apart(columns);
  plan.joints.of_column.resize(columns);
  code_columns(side, apart, plan.joints, plan.turnings);
  if (!side.exhausted()) fail("what columns have of their own is cut off, too long, or cannot be");
  std::int64_t exponent = base;
  std::vector<std::int64_t> exponents;
  for (const std::int64_t each : apart) {
    if (each < -kMostExponent || each > kMostExponent) fail("steps out of bounds");
    exponents.push_back(exponent += 32 * each);
  }
  put_steps(exponents);
  return plan;
}

void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan) {
  Decoding(payload, values, frames, plan).run();
  if (!plan.order.empty()) put_in_order(values, frames, plan.order);
}

}  // namespace mocapress::near
