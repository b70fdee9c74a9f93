#include "exact_fast/codec.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "coding/fail.hpp"
#include "coding/sides.hpp"
#include "exact/noise.hpp"
#include "exact_fast/neighbours.hpp"
#include "exact_fast/ruler.hpp"
#include "exact_fast/symbols.hpp"

namespace mocapress::exact {
namespace {

constexpr double kLargest = 1e12;        // levels beyond are taken for this
constexpr std::size_t kSoundEvery = 16;  // frames
constexpr double kFirstScale = 16;       // levels: of a channel of which nothing is known
constexpr double kFirstError = 0.25;
constexpr double kFloor = 0.3;      // in steps: as close as a prediction can be expected to come
constexpr double kMostErrors = 20;  // an error beyond so many scales counts as one of them
constexpr int kMostOctaves = 900 * kOctave;
constexpr int kNarrower = 70;  // the tables' scale is smaller than the mean error

// How far off the predictions of each channel were lately, at two speeds.
class Errors {
 public:
  explicit Errors(std::size_t channels)
      : fast_(channels, kFirstError), slow_(channels, kFirstError) {}

  // In octaves, `floor` > 0 added.
  int usual(std::size_t channel, double floor) const {
    return (5 * octaves(fast_[channel] + floor) + 3 * octaves(slow_[channel] + floor)) / 8;
  }

  void learn(std::size_t channel, double size) {
    fast_[channel] += fast_rate_ * (size - fast_[channel]);
    slow_[channel] += slow_rate_ * (size - slow_[channel]);
  }

  void next_frame() {
    ++seen_;
    fast_rate_ = std::max(0.25, 1.0 / seen_);
    slow_rate_ = std::max(0.06, 1.0 / seen_);
  }

 private:
  std::vector<double> fast_;
  std::vector<double> slow_;
  int seen_ = 0;
  double fast_rate_ = 1;
  double slow_rate_ = 1;
};

// How much farther off than usual the channels before were, in this frame mostly: a running mean
// in 1/256 of what octaves() has.
class Activity {
 public:
  int level() const { return mean_ >> 9; }  // half of it is to be expected again

  void learn(double size, double scale, int log_scale) {
    const int more = octaves(size + 0.1 * scale) - log_scale + kUsual;
    mean_ += (std::clamp(more, -kMost, kMost) * 256 - mean_) >> 3;
  }

 private:
  static constexpr int kUsual = 185;
  static constexpr int kMost = 3 * kOctave;
  int mean_ = 0;
};

double sane(double level) {
  return level > -kLargest && level < kLargest ? level : level >= kLargest ? kLargest : -kLargest;
}

template <int kOwn, int kOthers>
class FastModel {
 public:
  FastModel(std::span<const Column> columns, double fading)
      : noise_(columns),
        count_(noise_.first()),
        neighbours_(count_, {kOwn, kOthers, fading}),
        errors_(count_),
        last_(count_),
        next_(count_) {
    for (std::size_t c = 0; c < count_; ++c) rulers_.emplace_back(columns[c]);
  }

  template <class Side>
  void code_frame(Side& side, double* row) {
    noise_.code(side, row);
    for (std::size_t c = 0; c < count_; ++c) row[c] = code_number(side, c, row[c]);
    if (!first_) neighbours_.learn();
    errors_.next_frame();
    first_ = false;
  }

 private:
  template <class Side>
  double code_number(Side& side, std::size_t c, double number) {
    Ruler& ruler = rulers_[c];
    const double predicted = sane(neighbours_.template predict<kOthers>(c, next_[c]));
    const int log_scale =
        first_ ? octaves(kFirstScale)
               : std::clamp(errors_.usual(c, kFloor * ruler.step()) + activity_.level() - kNarrower,
                            -kMostOctaves, kMostOctaves);
    const double scale = from_octaves(log_scale);
    ruler.reach(std::fabs(predicted) + scale);
    const std::int64_t near = ruler.near(predicted);

    Ruler::Place place{0, 0, false, true};
    std::int64_t distance = 0;
    if constexpr (!Side::kReading) {
      place = ruler.place(number);
      distance = place.steps - near;
    }
    distance = Distances::code(side, log_scale - ruler.log_step(), distance, place.on_line);
    double level = 0;
    if (place.on_line) {
      place.steps = static_cast<std::int64_t>(static_cast<std::uint64_t>(near) +
                                              static_cast<std::uint64_t>(distance));
      number = ruler.finish(side, place, level);
    } else {
      number = std::bit_cast<double>(side.raw(64, std::bit_cast<std::uint64_t>(number)));
      level = ruler.level(number);
    }
    learn(c, std::isfinite(level) ? sane(level) : predicted, predicted, scale, log_scale);
    return number;
  }

  void learn(std::size_t c, double level, double predicted, double scale, int log_scale) {
    if (first_) {
      last_[c] = next_[c] = level;
      return;
    }
    const double size = std::fabs(level - predicted);
    errors_.learn(c, std::min(size, kMostErrors * scale));
    activity_.learn(size, scale, log_scale);
    neighbours_.set(c, level - next_[c]);
    next_[c] = level + (level - last_[c]);
    last_[c] = level;
  }

  NoiseColumns noise_;
  std::size_t count_;  // columns that are predicted
  Neighbours neighbours_;
  Errors errors_;
  Activity activity_;
  std::vector<Ruler> rulers_;
  std::vector<double> last_;  // levels
  std::vector<double> next_;  // where the last two levels lead
  bool first_ = true;
};

template <class Action>
void with_model(const Clip& clip, Action action) {
  if (clip.level == 1) {
    action(FastModel<2, 4>(clip.columns, 0.91));
  } else {
    action(FastModel<2, 8>(clip.columns, 0.9));
  }
}

}  // namespace

Bytes encode_fast(const double* values, std::size_t frames, const Clip& clip, Start* learned) {
  RansWriting side;
  const std::size_t count = clip.columns.size();
  std::vector<double> row(count);
  with_model(clip, [&](auto model) {
    for (std::size_t f = 0; f < frames; ++f) {
      std::copy_n(values + f * count, count, row.data());
      model.code_frame(side, row.data());
    }
  });
  if (learned != nullptr) *learned = {{}, std::vector<std::vector<float>>(count)};
  return side.finish();
}

void decode_fast(ByteView payload, double* values, std::size_t frames, const Clip& clip,
                 bool whole) {
  RansReading side(payload);
  with_model(clip, [&](auto model) {
    for (std::size_t f = 0; f < frames; ++f) {
      if (f % kSoundEvery == 0 && !side.sound()) break;
      model.code_frame(side, values + f * clip.columns.size());
    }
  });
  if (whole ? !side.exhausted() : !side.sound()) {
    fail("the payload does not decode");
  }
}

}  // namespace mocapress::exact
