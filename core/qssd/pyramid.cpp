#include "qssd/pyramid.hpp"

namespace mocapress::qssd {
namespace {

// Lagrange's polynomial through the frames that a sample is predicted from.
void weigh(Sample& sample) {
  const auto at = static_cast<double>(sample.frame);
  for (std::size_t i = 0; i < sample.count; ++i) {
    const auto own = static_cast<double>(sample.from[i]);
    double over = 1, under = 1;
    for (std::size_t j = 0; j < sample.count; ++j) {
      if (i == j) continue;
      const auto other = static_cast<double>(sample.from[j]);
      over *= at - other;
      under *= own - other;
    }
    sample.weights[i] = over / under;
  }
}

// The frame at t between two that are known: from them and from the next on either side.
Sample between(std::size_t t, std::size_t stride, std::size_t last) {
  Sample sample{t};
  const auto take = [&](std::size_t frame) { sample.from[sample.count++] = frame; };
  const std::size_t behind = std::min(t + stride, last), next = std::min(t + 3 * stride, last);
  take(t - stride);
  take(behind);
  if (t >= 3 * stride) take(t - 3 * stride);
  if (next > behind) take(next);
  weigh(sample);
  return sample;
}

}  // namespace

std::vector<Stage> stages_of(std::size_t frames, int levels) {
  std::vector<Stage> stages;
  if (frames == 0) return stages;
  const std::size_t widest = std::size_t{1} << levels, last = frames - 1;
  stages.push_back({0, widest, {Sample{0}}});
  for (std::size_t t = 0; t < last;) {
    const std::size_t next = std::min(t + widest, last);
    stages.push_back({1, widest, {Sample{next, 1, {t}, {1}}}});
    t = next;
  }
  std::size_t kind = 2;
  for (std::size_t stride = widest / 2; stride > 0; stride /= 2, ++kind) {
    Stage stage{kind, stride, {}};
    for (std::size_t t = stride; t < last; t += 2 * stride) {
      stage.samples.push_back(between(t, stride, last));
    }
    stages.push_back(std::move(stage));
  }
  return stages;
}

Quaternion predicted_turn(const Pose& pose, const Body& body, const Sample& sample,
                          std::size_t joint) {
  const auto known = [&](std::size_t i) -> const Quaternion& {
    return pose.turns[sample.from[i] * body.joints.size() + joint];
  };
  if (sample.count == 0) return body.joints[joint].reference;
  if (sample.count == 1) return known(0);
  Quaternion sum{};
  for (std::size_t i = 0; i < sample.count; ++i) {
    const Quaternion& turn = known(i);
    const double weight = dot(turn, known(0)) < 0 ? -sample.weights[i] : sample.weights[i];
    for (std::size_t part = 0; part < 4; ++part) sum[part] += weight * turn[part];
  }
  const double size = std::sqrt(dot(sum, sum));
  if (!(size > 1e-9)) return known(0);
  for (double& part : sum) part /= size;
  return sum;
}

double predicted_number(const Pose& pose, const Body& body, const Sample& sample,
                        std::size_t number) {
  if (sample.count == 0) return body.numbers[number].reference;
  double sum = 0;
  for (std::size_t i = 0; i < sample.count; ++i) {
    sum += sample.weights[i] * pose.numbers[sample.from[i] * body.numbers.size() + number];
  }
  return sum;
}

}  // namespace mocapress::qssd
