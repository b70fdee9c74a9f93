#include "near/prediction.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

constexpr std::size_t kMostSources = 20;
constexpr double kAssumed = 50;  // observations that count as seen where a start is known
constexpr double kFade = 0.95;   // of what was seen, in a span

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
                       double caution)
    : channels_(sources.size()), caution_(caution) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Own& own = channels_[i];
    own.sources = std::move(sources[i]);
    own.step = steps[i];
    own.last = firsts[i];
    std::fill_n(own.past, kReach + 1, firsts[i]);
    const std::size_t features = 2 * own.sources.size();
    own.products.assign(filled(features) * filled(features), 0.0);
    own.targets.assign(filled(features), 0.0);
  }
}

void Prediction::assume(const std::vector<Assumed>& all, const std::vector<std::size_t>& columns) {
  if (all.empty()) return;
  const auto before = [](const Assumed& one, const std::array<std::size_t, 2>& place) {
    return std::array{one.channel, one.source} < place;
  };
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Own& own = channels_[i];
    const std::size_t m = 2 * own.sources.size(), next = filled(m);
    for (std::size_t a = 0; a < m; a += 2) {
      const std::size_t source = own.sources[a / 2];
      const std::array place{columns[i], columns[source]};
      const auto found = std::lower_bound(all.begin(), all.end(), place, before);
      if (found == all.end() || std::array{found->channel, found->source} != place) continue;
      const double ratio = channels_[source].step / own.step;
      const double square = kAssumed * (ratio * ratio), once = kAssumed * ratio;
      const auto& [one, other] = found->shares;
      own.products[a * next + a] = square * found->moved;
      own.products[a * next + a + 1] = square * found->both;
      own.products[(a + 1) * next + a + 1] = square * found->averaged;
      own.targets[a] = once * (found->moved * one + found->both * other);
      own.targets[a + 1] = once * (found->both * one + found->averaged * other);
    }
  }
  seen_ = kAssumed;
  caution_ = 0;
}

void Prediction::begin_span(int length) { length_ = static_cast<std::size_t>(length); }

void Prediction::predict(std::size_t i, double* curve) {
  const Own& own = channels_[i];
  const std::size_t m = 2 * own.sources.size(), next = filled(m);
  bool solved = m > 0 && seen_ > 0;
  if (solved) {
    scratch_ = own.products;
    shares_ = own.targets;
    for (std::size_t a = 0; a < m; ++a) {
      const double step = channels_[own.sources[a / 2]].step;
      double& entry = scratch_[a * next + a];
      entry = entry + entry * (caution_ / seen_);
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
    find_waves(group * kGroup);
    for (std::size_t i = 0; i < channels_.size(); ++i) learn(i);
    seen_ += static_cast<double>(kWaves);
  }
  seen_ = seen_ * kFade;
  for (Own& own : channels_) {
    for (double& product : own.products) product *= kFade;
    for (double& target : own.targets) target *= kFade;
    for (std::size_t k = 0; k <= kReach; ++k) own.past[k] = own.values[length_ - 1 - kReach + k];
    own.last = own.values[length_ - 1];
  }
}

// The waves of a group of frames, from `start` on.
void Prediction::find_waves(std::size_t start) {
  const std::size_t moving = filled(2 * channels_.size());
  moves_.assign(kGroup * moving, 0.0);
  rest_of_.clear();
  std::size_t count = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Own& own = channels_[i];
    for (std::size_t t = 0; t < kGroup; ++t) {
      moves_[t * moving + 2 * i] = own.moved[start + t];
      moves_[t * moving + 2 * i + 1] = own.averaged[start + t];
    }
    rest_of_.push_back(count);
    if (!own.rests) ++count;
  }
  const std::size_t resting = filled(count);
  rests_.assign(kGroup * resting, 0.0);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].rests) continue;
    for (std::size_t t = 0; t < kGroup; ++t) {
      rests_[t * resting + rest_of_[i]] = channels_[i].rest[start + t];
    }
  }
  move_waves_.resize(kWaves * moving);
  rest_waves_.resize(kWaves * resting);
  waves_of(moves_.data(), moving, move_waves_.data());
  waves_of(rests_.data(), resting, rest_waves_.data());
}

// Adds to the normal equations of a channel what the waves of a group of frames show.
void Prediction::learn(std::size_t i) {
  Own& own = channels_[i];
  const std::size_t m = 2 * own.sources.size(), next = filled(m);
  if (m == 0) return;
  const std::size_t moving = move_waves_.size() / kWaves, resting = rest_waves_.size() / kWaves;
  std::array<double, kWaves + 4> squares{};
  for (std::size_t k = 0; k < kWaves && !own.rests; ++k) {
    const double wave = rest_waves_[k * resting + rest_of_[i]];
    squares[k + 2] = wave * wave;
  }
  features_.resize(kWaves * next);
  weighed_.resize(kWaves * next);
  std::array<double, kWaves> aims;
  for (std::size_t k = 0; k < kWaves; ++k) {
    double energy = 0;
    for (std::size_t j = k; j < k + 5; ++j) energy += squares[j];
    const double weight = 1 / (own.step * own.step + energy / 5);
    const double* const waves = &move_waves_[k * moving];
    double* const feature = &features_[k * next];
    double* const weighed = &weighed_[k * next];
    for (std::size_t a = 0; a < m; a += 2) {
      std::memcpy(feature + a, waves + 2 * own.sources[a / 2], 2 * sizeof(double));
    }
    for (std::size_t a = m; a < next; ++a) feature[a] = 0;
    for (std::size_t a = 0; a < next; ++a) weighed[a] = weight * feature[a];
    aims[k] = waves[2 * i];
  }
  add_products(features_.data(), weighed_.data(), aims.data(), next, own.products.data(),
               own.targets.data());
}

}  // namespace mocapress::near
