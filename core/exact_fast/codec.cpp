#include "exact_fast/codec.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "coding/fail.hpp"
#include "coding/sides.hpp"
#include "exact/expert.hpp"
#include "exact/noise.hpp"
#include "exact_fast/lawful.hpp"
#include "exact_fast/neighbours.hpp"
#include "exact_fast/ruler.hpp"
#include "exact_fast/second.hpp"
#include "exact_fast/symbols.hpp"

namespace mocapress::exact {
namespace {

constexpr double kLargest = 1e12;        // levels beyond are taken for this
constexpr std::size_t kSoundEvery = 16;  // frames
constexpr double kFirstScale = 16;       // levels: of a channel of which nothing is known
constexpr double kFirstError = 0.25;
constexpr double kLeastScale = 1e-100;  // its square is not 0
constexpr double kFloor = 0.1;     // in steps: as close as a prediction can be expected to come
constexpr double kMostErrors = 8;  // an error beyond so many scales counts as one of them
constexpr int kMostOctaves = 900 * kOctave;
constexpr int kNarrower = 65;  // the tables' scale is smaller than the mean error

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
    fast_rate_ = std::max(0.35, 1.0 / seen_);
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
  int level() const { return mean_ >> 8; }

  void learn(double size, double scale, int log_scale) {
    const int more = octaves(size + 0.1 * scale) - log_scale + kUsual;
    mean_ += (std::clamp(more, -kMost, kMost) * 256 - mean_) >> 3;
  }

 private:
  static constexpr int kUsual = 185;
  static constexpr int kMost = 3 * kOctave;
  int mean_ = 0;
};

double cut(double level) {
  return level > -kLargest && level < kLargest ? level : level >= kLargest ? kLargest : -kLargest;
}

// In place of a second prediction.
struct NoSecond {
  explicit NoSecond(std::size_t) {}
};

template <class Neighbours, class Second = NoSecond>
class FastModel {
  static constexpr bool kSecond = !std::is_same_v<Second, NoSecond>;

 public:
  FastModel(const Clip& clip, float fading, bool lawful)
      : noise_(clip.columns),
        count_(noise_.first()),
        frames_(count_),
        neighbours_(count_, fading),
        second_(count_),
        errors_(count_) {
    for (std::size_t c = 0; c < count_; ++c) rulers_.emplace_back(clip.columns[c]);
    if (lawful) laws_.emplace(clip);
  }

  template <class Side>
  void code_frame(Side& side, double* row) {
    noise_.code(side, row);
    frames_.next();
    if constexpr (kSecond) second_.begin(frames_);
    for (std::size_t c = 0; c < count_; ++c) row[c] = code_number(side, c, row[c]);
    errors_.next_frame();
    if (first_) {
      frames_.fill();
    } else {
      neighbours_.learn();
      if constexpr (kSecond) second_.learn(frames_);
    }
    first_ = false;
  }

 private:
  template <class Side>
  double code_number(Side& side, std::size_t c, double number) {
    Ruler& ruler = rulers_[c];
    const double before = frames_.level(c, 1);
    double move = frames_.difference(c, 1, 1) + neighbours_.predict(c);
    if constexpr (kSecond) move = second_.blend(c, move);
    ToldByLaw* const told = first_ || !laws_ ? nullptr : laws_->of(c);
    if (told != nullptr) move = told->choose(c, frames_, move);
    double predicted = cut(before + move);
    const int log_scale =
        first_ ? octaves(kFirstScale)
               : std::clamp(errors_.usual(c, kFloor * ruler.step()) + activity_.level() - kNarrower,
                            -kMostOctaves, kMostOctaves);
    const double scale = from_octaves(log_scale);
    if constexpr (kSecond) {
      if (told == nullptr) predicted = cut(before + (move + second_.moved_by_past(c, scale)));
    }
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
    level = std::isfinite(level) ? cut(level) : predicted;
    frames_.set(c, level);
    if (first_) return number;
    if (told != nullptr) told->learn(level - before, scale);
    const double size = std::fabs(level - predicted);
    errors_.learn(c, std::min(size, kMostErrors * scale));
    activity_.learn(size, scale, log_scale);
    neighbours_.set(c, static_cast<float>(frames_.bend(c)));
    if constexpr (kSecond) {
      second_.see(c, level - before, std::max(scale, kLeastScale), told == nullptr);
    }
    return number;
  }

  NoiseColumns noise_;
  std::size_t count_;  // columns that are predicted
  Frames frames_;
  Neighbours neighbours_;
  Second second_;
  std::optional<ToldByLaws> laws_;
  Errors errors_;
  Activity activity_;
  std::vector<Ruler> rulers_;
  bool first_ = true;
};

template <class Action>
void with_model(const Clip& clip, Action action) {
  switch (clip.level) {
    case 1:
      return action(FastModel<Neighbours<2, 0, 4>>(clip, 0.91f, false));
    case 2:
      return action(FastModel<Neighbours<2, 0, 8>>(clip, 0.9f, false));
    case 3:
      return action(FastModel<Neighbours<2, 0, 8>>(clip, 0.9f, true));
    case 4:
      return action(FastModel<Neighbours<0, 0, 8>, Second<false>>(clip, 0.9f, true));
    default:
      return action(FastModel<Neighbours<0, 6, 6>, Second<true>>(clip, 0.93f, true));
  }
}

}  // namespace

Bytes encode_fast(const double* values, std::size_t frames, const Clip& clip, Start* learned) {
  RansWriting side;
  const std::size_t count = clip.columns.size();
  std::vector<double> row(count);
  with_model(clip, [&](auto&& model) {
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
  with_model(clip, [&](auto&& model) {
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
