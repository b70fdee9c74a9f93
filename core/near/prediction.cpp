#include "near/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "numbers/arithmetic.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")  // see blocks.cpp
#endif

namespace mocapress::near {
namespace {

constexpr std::size_t kMostSources = 20;
constexpr double kFade = 0.95;  // of what was seen, in a span

// sqrt(2 / 64) cos(pi k (t + 1/2) / 64) at [64 (k - 1) + t].
const std::vector<double>& cosines() {
  static const auto kCosines = [] {
    std::vector<double> turns(256), table(std::size_t{63} * 64);
    const double height = std::sqrt(2.0 / 64);
    for (std::size_t i = 0; i < 256; ++i) {
      turns[i] = height * sine_cosine(3.141592653589793 * static_cast<double>(i) / 128).cosine;
    }
    for (std::size_t k = 1; k < 64; ++k) {
      for (std::size_t t = 0; t < 64; ++t) table[64 * (k - 1) + t] = turns[k * (2 * t + 1) % 256];
    }
    return table;
  }();
  return kCosines;
}

// The waves 1 to 63 of 64 numbers.
void waves_of(const double* numbers, double* waves) {
  const double* table = cosines().data();
  for (std::size_t k = 0; k < 63; ++k, table += 64) {
    double sum = 0;
    for (std::size_t t = 0; t < 64; ++t) sum += table[t] * numbers[t];
    waves[k] = sum;
  }
}

// Solves the equations of a symmetric matrix of which the lower half is told; false where it is
// not positive.
bool solve(std::vector<double>& matrix, std::vector<double>& x) {
  const std::size_t m = x.size();
  for (std::size_t i = 0; i < m; ++i) {
    double* const row = &matrix[i * m];
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = row[j];
      for (std::size_t k = 0; k < j; ++k) sum -= row[k] * matrix[j * m + k];
      if (j < i) {
        row[j] = sum / matrix[j * m + j];
      } else if (sum > 0) {
        row[i] = std::sqrt(sum);
      } else {
        return false;
      }
    }
    for (std::size_t k = 0; k < i; ++k) x[i] -= row[k] * x[k];
    x[i] /= row[i];
  }
  for (std::size_t i = m; i-- > 0;) {
    for (std::size_t k = i + 1; k < m; ++k) x[i] -= matrix[k * m + i] * x[k];
    x[i] /= matrix[i * m + i];
  }
  return true;
}

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
    own.products.assign(features * features, 0.0);
    own.targets.assign(features, 0.0);
  }
}

void Prediction::assume(const std::vector<Assumed>& all, double observations,
                        const std::vector<std::size_t>& columns) {
  if (all.empty()) return;
  const auto before = [](const Assumed& one, const std::array<std::size_t, 2>& place) {
    return std::array{one.channel, one.source} < place;
  };
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Own& own = channels_[i];
    const std::size_t m = 2 * own.sources.size();
    for (std::size_t a = 0; a < m; a += 2) {
      const std::size_t source = own.sources[a / 2];
      const std::array place{columns[i], columns[source]};
      const auto found = std::lower_bound(all.begin(), all.end(), place, before);
      if (found == all.end() || std::array{found->channel, found->source} != place) continue;
      const double ratio = channels_[source].step / own.step;
      const double square = observations * (ratio * ratio), once = observations * ratio;
      const auto& [one, other] = found->shares;
      own.products[a * m + a] = square * found->moved;
      own.products[(a + 1) * m + a] = square * found->both;
      own.products[(a + 1) * m + a + 1] = square * found->averaged;
      own.targets[a] = once * (found->moved * one + found->both * other);
      own.targets[a + 1] = once * (found->both * one + found->averaged * other);
    }
  }
  seen_ = observations;
  caution_ = 0;
}

void Prediction::begin_span(int length) { length_ = static_cast<std::size_t>(length); }

void Prediction::predict(std::size_t i, double* curve) {
  Own& own = channels_[i];
  std::fill_n(curve, length_, 0.0);
  const std::size_t m = 2 * own.sources.size();
  if (m == 0 || seen_ == 0) return;
  std::vector<double> matrix = own.products, shares = own.targets;
  for (std::size_t a = 0; a < m; ++a) {
    const double step = channels_[own.sources[a / 2]].step;
    double& entry = matrix[a * m + a];
    entry = entry + entry * (caution_ / seen_);
    entry = entry + step * step / (own.step * own.step);
  }
  if (!solve(matrix, shares)) return;
  for (std::size_t a = 0; a < m; ++a) {
    const Own& source = channels_[own.sources[a / 2]];
    const double* const feature = a % 2 == 0 ? source.moved.data() : source.averaged.data();
    const double share = shares[a];
    for (std::size_t t = 0; t < length_; ++t) curve[t] += share * feature[t];
  }
}

void Prediction::tell(std::size_t i, const double* values, const double* rest) {
  Own& own = channels_[i];
  own.values.assign(values, values + length_);
  own.rest.assign(rest, rest + length_);
  own.moved.resize(length_);
  for (std::size_t t = 0; t < length_; ++t) own.moved[t] = values[t] - own.last;
  average(own);
}

// Averages with weights that fall to both sides; behind the span stands its last value.
void Prediction::average(Own& own) const {
  std::vector<double> whole(own.past, own.past + kReach + 1);
  whole.insert(whole.end(), own.values.begin(), own.values.end());
  whole.insert(whole.end(), kReach, own.values.back());
  own.averaged.assign(length_, 0.0);
  double before = 0;
  for (std::size_t k = 0; k <= 2 * kReach; ++k) {
    const auto weight = static_cast<double>(k <= kReach ? k + 1 : 2 * kReach + 1 - k);
    const double* const from = whole.data() + k + 1;
    for (std::size_t t = 0; t < length_; ++t) own.averaged[t] += weight * from[t];
    before += weight * (k <= kReach ? own.past[k] : own.values[k - kReach - 1]);
  }
  for (double& value : own.averaged)
    value = (value - before) / static_cast<double>((kReach + 1) * (kReach + 1));
}

void Prediction::end_span(std::size_t frames) {
  std::vector<double> waves(channels_.size() * 3 * kWaves);
  for (std::size_t group = 0; (group + 1) * kGroup <= frames; ++group) {
    const std::size_t start = group * kGroup;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      double* const own = &waves[i * 3 * kWaves];
      waves_of(&channels_[i].moved[start], own);
      waves_of(&channels_[i].averaged[start], own + kWaves);
      waves_of(&channels_[i].rest[start], own + 2 * kWaves);
    }
    for (std::size_t i = 0; i < channels_.size(); ++i) learn(i, waves);
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

// Adds to the normal equations of a channel what a group of frames shows.
void Prediction::learn(std::size_t i, const std::vector<double>& waves) {
  Own& own = channels_[i];
  const std::size_t m = 2 * own.sources.size();
  const double* const target = &waves[i * 3 * kWaves];
  const double* const rest = target + 2 * kWaves;
  std::vector<double> sources(m);
  for (std::size_t k = 0; k < kWaves; ++k) {
    double energy = 0;
    for (std::size_t j = k - std::min<std::size_t>(k, 2); j < std::min(kWaves, k + 3); ++j) {
      energy += rest[j] * rest[j];
    }
    const double weight = 1 / (own.step * own.step + energy / 5);
    for (std::size_t a = 0; a < m; ++a) {
      sources[a] = waves[(own.sources[a / 2] * 3 + a % 2) * kWaves + k];
    }
    for (std::size_t a = 0; a < m; ++a) {
      const double weighed = weight * sources[a];
      own.targets[a] += weighed * target[k];
      double* const row = &own.products[a * m];
      for (std::size_t b = 0; b <= a; ++b) row[b] += weighed * sources[b];
    }
  }
}

}  // namespace mocapress::near
