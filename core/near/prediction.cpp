#include "near/prediction.hpp"

#include <algorithm>
#include <array>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

constexpr std::size_t kMostSources = 20;
constexpr double kMostCaution = 3;  // where something is assumed

}  // namespace

std::vector<std::vector<std::size_t>> sources_of(const Joints& joints,
                                                 const std::vector<std::size_t>& columns) {
  std::vector<std::vector<std::size_t>> sources(columns.size());
  const auto parent = [&](std::int32_t joint) {
    return joint < 0 ? -1 : joints.parents[static_cast<std::size_t>(joint)];
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::int32_t own = joints.of_column[columns[i]];
    const std::int32_t above = parent(own), further = parent(above);
    for (std::size_t k = i; k-- > 0 && sources[i].size() < kMostSources;) {
      const std::int32_t other = joints.of_column[columns[k]];
      bool related = other == 0;
      std::int32_t joint = own;
      for (int up = 0; up < 5 && joint >= 0; ++up, joint = parent(joint)) {
        related = related || other == joint;
      }
      related = related || (above >= 0 && parent(other) == above) ||
                (further >= 0 && parent(other) == further);
      if (related) sources[i].push_back(k);
    }
  }
  return sources;
}

Prediction::Prediction(std::vector<std::vector<std::size_t>> sources,
                       const std::vector<double>& steps, const std::vector<double>& firsts,
                       Pace pace)
    : channels_(sources.size()), pace_(pace) {
  std::size_t places = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Own& own = channels_[i];
    own.sources = std::move(sources[i]);
    own.step = steps[i];
    own.last = firsts[i];
    std::fill_n(own.past, kReach + 1, firsts[i]);
    own.place = places;
    places += own.sources.size() * (own.sources.size() + 3) / 2;
  }
  equations_.assign(4 * places, 0.0);
}

void Prediction::assume(const std::vector<Assumed>& all, double observations,
                        const std::vector<std::size_t>& columns) {
  if (all.empty()) return;
  const auto before = [](const Assumed& one, const std::array<std::size_t, 2>& place) {
    return std::array{one.channel, one.source} < place;
  };
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Own& own = channels_[i];
    const std::size_t count = own.sources.size();
    double* const targets = equations_.data() + 4 * own.place;
    double* square_at = targets + 4 * count;
    for (std::size_t a = 0; a < count; square_at += 4 * (count - a), ++a) {
      const std::size_t source = own.sources[a];
      const std::array place{columns[i], columns[source]};
      const auto found = std::lower_bound(all.begin(), all.end(), place, before);
      if (found == all.end() || std::array{found->channel, found->source} != place) continue;
      const double ratio = channels_[source].step / own.step;
      const double square = observations * (ratio * ratio), once = observations * ratio;
      const auto& [one, other] = found->shares;
      square_at[0] = square * found->moved;
      square_at[1] = square_at[2] = square * found->both;
      square_at[3] = square * found->averaged;
      targets[4 * a] = once * (found->moved * one + found->both * other);
      targets[4 * a + 1] = once * (found->both * one + found->averaged * other);
    }
  }
  seen_ = observations;
  pace_.caution = std::min(pace_.caution, kMostCaution);
}

void Prediction::begin_span(int length) { length_ = static_cast<std::size_t>(length); }

void Prediction::predict(std::size_t i, double* curve) {
  const Own& own = channels_[i];
  const std::size_t m = 2 * own.sources.size(), next = filled(m + 1);
  bool solved = m > 0 && seen_ > 0;
  if (solved) {
    scratch_.assign(m * next, 0.0);
    shares_.resize(m);
    const double* from = equations_.data() + 4 * own.place;
    for (std::size_t a = 0; a < m; ++a) scratch_[a * next + m] = from[2 * (a - a % 2) + a % 2];
    from += 2 * m;
    for (std::size_t a = 0; a < m; a += 2) {
      for (std::size_t b = a; b < m; b += 2, from += 4) {
        std::copy_n(from, 2, &scratch_[a * next + b]);
        std::copy_n(from + 2, 2, &scratch_[(a + 1) * next + b]);
      }
    }
    for (std::size_t a = 0; a < m; ++a) {
      const double step = channels_[own.sources[a / 2]].step;
      double& entry = scratch_[a * next + a];
      entry = entry + entry * (pace_.caution / seen_);
      entry = entry + step * step / (own.step * own.step);
    }
    solved = solve(scratch_.data(), shares_.data(), m);
  }
  curves_.clear();
  for (std::size_t k = 0; solved && k < own.sources.size(); ++k) {
    const Own& source = channels_[own.sources[k]];
    curves_.push_back(source.moved.data());
    curves_.push_back(source.averaged.data());
  }
  weigh(curves_.data(), shares_.data(), curves_.size(), length_, curve);
}

void Prediction::tell(std::size_t i, const double* values, const double* rest) {
  Own& own = channels_[i];
  own.values.assign(values, values + length_);
  own.rest.assign(rest, rest + length_);
  own.rests = std::all_of(rest, rest + length_, [](double one) { return one == 0; });
  own.moved.resize(length_);
  for (std::size_t t = 0; t < length_; ++t) own.moved[t] = values[t] - own.last;
  // Averages have weights that fall to both sides; behind the span stands its last value.
  scratch_.assign(own.past + 1, own.past + kReach + 1);
  scratch_.insert(scratch_.end(), values, values + length_);
  scratch_.insert(scratch_.end(), kReach, values[length_ - 1]);
  double before = 0;
  for (std::size_t k = 0; k <= 2 * kReach; ++k) {
    const auto weight = static_cast<double>(k <= kReach ? k + 1 : 2 * kReach + 1 - k);
    before += weight * (k <= kReach ? own.past[k] : values[k - kReach - 1]);
  }
  own.averaged.resize(length_);
  average(scratch_.data(), length_, own.averaged.data());
  for (double& value : own.averaged)
    value = (value - before) / static_cast<double>((kReach + 1) * (kReach + 1));
}

void Prediction::end_span(std::size_t frames) {
  for (std::size_t group = 0; (group + 1) * kGroup <= frames; ++group) {
    if (uses_.empty()) find_uses();
    find_waves(group * kGroup);
    weigh_bands();
    add_products(move_waves_.data(), uses_, weights_.data(), equations_.data());
    seen_ += static_cast<double>(kWaves);
  }
  seen_ = seen_ * pace_.fade;
  for (double& each : equations_) each *= pace_.fade;
  for (Own& own : channels_) {
    for (std::size_t k = 0; k <= kReach; ++k) own.past[k] = own.values[length_ - 1 - kReach + k];
    own.last = own.values[length_ - 1];
  }
}

// Which products make the equations of all channels.
void Prediction::find_uses() {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Own& own = channels_[i];
    std::size_t place = own.place;
    const auto use = [&](std::size_t row, std::size_t column) {
      uses_.push_back({static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column),
                       static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(place++)});
    };
    for (const std::size_t source : own.sources) use(i, source);
    for (std::size_t a = 0; a < own.sources.size(); ++a) {
      for (std::size_t b = a; b < own.sources.size(); ++b) use(own.sources[a], own.sources[b]);
    }
  }
  sort_uses(uses_, channels_.size());
}

// The waves of a group of frames, from `start` on.
void Prediction::find_waves(std::size_t start) {
  constexpr std::size_t kHalf = kGroup / 2;
  const std::size_t moving = filled(2 * channels_.size());
  moves_.assign(kGroup * moving, 0.0);
  rest_of_.clear();
  std::size_t count = 0;
  const auto put = [&](std::vector<double>& rows, std::size_t column,
                       const std::vector<double>& numbers) {
    double* const own = &rows[column / kFill * kFill * kGroup + column % kFill];
    for (std::size_t t = 0; t < kHalf; ++t) {
      const double one = numbers[start + t], other = numbers[start + kGroup - 1 - t];
      own[t * kFill] = one + other;
      own[(kHalf + t) * kFill] = one - other;
    }
  };
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Own& own = channels_[i];
    put(moves_, 2 * i, own.moved);
    put(moves_, 2 * i + 1, own.averaged);
    rest_of_.push_back(count);
    if (!own.rests) ++count;
  }
  const std::size_t resting = filled(count);
  rests_.assign(kGroup * resting, 0.0);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (!channels_[i].rests) put(rests_, rest_of_[i], channels_[i].rest);
  }
  move_waves_.resize(kWaves * moving);
  rest_waves_.resize(kWaves * resting);
  waves_of(moves_.data(), moving, move_waves_.data());
  waves_of(rests_.data(), resting, rest_waves_.data());
}

// What waves count in the equations of each channel: the less, the more its rest has of their band.
void Prediction::weigh_bands() {
  weights_.resize(channels_.size() * kWaveBands);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Own& own = channels_[i];
    const std::size_t column = rest_of_[i];
    const double* const waves =
        rest_waves_.data() + column / kFill * kFill * kWaves + column % kFill;
    std::size_t k = 0;
    for (std::size_t band = 0; band < kWaveBands; ++band) {
      const std::size_t first = k;
      double energy = 0;
      for (; k < kBandEnds[band]; ++k) {
        const double wave = own.rests ? 0 : waves[k * kFill];
        energy += wave * wave;
      }
      weights_[i * kWaveBands + band] =
          1 / (own.step * own.step + energy / static_cast<double>(k - first));
    }
  }
}

}  // namespace mocapress::near
