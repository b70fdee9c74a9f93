#include "exact/network.hpp"

#include <algorithm>
#include <cmath>

#include "numbers/arithmetic.hpp"
#include "numbers/vector_clones.hpp"

namespace mocapress::exact {
namespace {

constexpr int kValueBits = 8;    // behind the point
constexpr int kWeightBits = 10;  // the same
constexpr int kMostValue = 4095;
constexpr double kMostUnits = 4;  // spans
constexpr double kTiny = 1e-9;

using Value = std::int16_t;

double cut(double value, double most) {
  return value > most ? most : value > -most ? value : -most;
}

MOCAPRESS_IN_PLACE std::int32_t product(const Value* a, const Value* b, std::size_t count) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<std::int32_t>(a[i]) * b[i];
  return sum;
}

std::int32_t biased(Value bias) { return std::int32_t{bias} << kValueBits; }

template <std::size_t kCount>
MOCAPRESS_IN_PLACE void layer(const Value* values,
                              const std::array<std::array<Value, kCount>, kHidden>& weights,
                              const std::array<Value, kHidden>& biases, Value* outputs) {
  for (std::size_t i = 0; i < kHidden; ++i) {
    const std::int32_t sum = biased(biases[i]) + product(values, weights[i].data(), kCount);
    outputs[i] = static_cast<Value>(std::clamp(sum >> kWeightBits, 0, kMostValue));
  }
}

MOCAPRESS_VECTOR_CLONES
void run(const Value* inputs, Value* second, std::int32_t* outputs) {
  Value first[kHidden];
  layer(inputs, kNetwork.first, kNetwork.first_biases, first);
  layer(first, kNetwork.second, kNetwork.second_biases, second);
  for (std::size_t i = 0; i < kOutputs; ++i) {
    outputs[i] = biased(kNetwork.biases[i]) + product(second, kNetwork.last[i].data(), kHidden);
  }
  outputs[0] += product(inputs, kNetwork.direct.data(), kNetworkInputs);
}

}  // namespace

Network::Network(std::size_t channels, bool tuned) : residuals_(channels + kBefore, 0) {
  static_assert(kInputs <= kNetworkInputs);
  for (auto& logs : logs_) logs = Lanes(channels, 0);
  for (auto& apart : apart_) apart.fill(Lanes(channels, 0));
  if (tuned) tuning_.emplace();
}

void Network::begin() {
  std::rotate(apart_.begin(), apart_.end() - 1, apart_.end());
  std::rotate(logs_.begin(), logs_.end() - 1, logs_.end());
  frames_ += 1;
}

void Network::gather(std::size_t c, const Known& known) {
  const double span = known.scale + known.step;
  const double log = natural_log(span);
  double* next = inputs_.data();
  for (const double residual : known.residuals) *next++ = residual;
  for (std::size_t i = 0; i < kNoSlot; ++i)
    apart_[0][i][c] = cut(known.apart[i] / span, kMostUnits);
  for (const auto& apart : apart_) {
    for (const Lanes& predictor : apart) *next++ = predictor[c];
  }
  for (std::size_t i = 1; i <= kBefore; ++i) *next++ = residuals_[c + kBefore - i];
  for (const std::size_t age : {1, 2, 4, 8}) {
    *next++ = frames_ > static_cast<double>(age) ? cut(log - logs_[age][c], 3) : 0;
  }
  *next++ = cut(log + 2, 6) / 3;
  *next++ = cut(known.last_move / span, 30) / 10;
  *next++ = cut(natural_log(known.scale / (known.step + kTiny)), 6) / 3;
  *next++ = cut(known.moved / span, kMostUnits);
  for (const double feature : known.spread) *next++ = feature;
  *next++ = 4 / (4 + frames_);
  *next++ = 32 / (32 + frames_);
}

Network::Told Network::tell(std::size_t c, const Known& known) {
  gather(c, known);
  Value inputs[kNetworkInputs] = {};
  for (std::size_t i = 0; i < kInputs; ++i) {
    const double scaled = inputs_[i] * (1 << kValueBits);
    inputs[i] = static_cast<Value>(scaled + (scaled < 0 ? -0.5 : 0.5));
  }
  Value hidden[kHidden];
  std::int32_t outputs[kOutputs];
  run(inputs, hidden, outputs);
  constexpr double kOne = 1 << (kValueBits + kWeightBits);
  double move = outputs[0] / kOne;
  double scale = outputs[1] / kOne;
  if (tuning_) {
    const Tuning::Sums sums = tuning_->tell(features(hidden));
    move += sums.move;
    scale += sums.scale;
  }
  return {cut(move, kMostUnits), natural_exp(cut(scale, 2))};
}

std::array<double, kHidden + Network::kInputs + 1> Network::features(const Value* hidden) const {
  std::array<double, kHidden + kInputs + 1> features;
  static_assert(features.size() <= Tuning::kFeatures);
  for (std::size_t i = 0; i < kHidden; ++i) features[i] = hidden[i] / double{1 << kValueBits};
  std::ranges::copy(inputs_, features.begin() + kHidden);
  features.back() = 1;
  return features;
}

void Network::see(std::size_t c, double residual, double span) {
  residuals_[c + kBefore] = cut(residual, kMostUnits);
  logs_[0][c] = natural_log(span);
}

void Network::show(double right, std::vector<float>& seen) const {
  seen.insert(seen.end(), inputs_.begin(), inputs_.end());
  seen.push_back(static_cast<float>(right));
}

}  // namespace mocapress::exact
