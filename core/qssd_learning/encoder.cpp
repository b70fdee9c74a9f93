#include "qssd_learning/encoder.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "qssd_learning/products.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// As in core/motion/kinematics.cpp: no fused operations of sums and differences side by side.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::qssd {
namespace {

constexpr double kMostDegrees = 1e6;
constexpr double kMostSteps = 1e12;
constexpr double kMostCorrections = 1e12;
constexpr double kLeast = 0.6;  // of a step: no atom is worth less

using Vector = std::array<double, 3>;

Vector logarithm(const Quaternion& q) {
  const double sine = length(q[1], q[2], q[3]);
  if (sine == 0) return {};
  const double half = q[0] < 0 ? -angle_of(sine, -q[0]) : angle_of(sine, q[0]);
  return {half / sine * q[1], half / sine * q[2], half / sine * q[3]};
}

bool is_coded(const Stage& stage, const Plan& plan) { return stage.stride >> plan.omitted != 0; }

// How large a column's values may be.
std::vector<double> limits_of(const Plan& plan) {
  std::vector<double> most(plan.body.columns, kMostDegrees);
  for (const Number& number : plan.body.numbers) {
    most[number.column] = kMostSteps * plan.step / number.importance;
  }
  return most;
}

// The values with those that cannot be coded replaced by the ones before, or behind.
std::vector<double> usable(const double* values, std::size_t frames, const Plan& plan) {
  const std::size_t columns = plan.body.columns;
  const auto most = limits_of(plan);
  std::vector<double> clean(values, values + frames * columns);
  const auto fits = [&](std::size_t c, double value) { return std::fabs(value) <= most[c]; };
  for (std::size_t c = 0; c < columns; ++c) {
    std::size_t first = 0;
    while (first < frames && !fits(c, values[first * columns + c])) ++first;
    double last = first < frames ? values[first * columns + c] : 0;
    for (std::size_t f = 0; f < frames; ++f) {
      double& value = clean[f * columns + c];
      if (!fits(c, value)) value = last;
      last = value;
    }
  }
  return clean;
}

// The update steps of the levels that are omitted: what a frame differs from its prediction by is
// shared out to the two beside it.
void update(Pose& pose, const std::vector<Stage>& stages, const Plan& plan) {
  constexpr double kShare = 0.25;
  const std::size_t joints = plan.body.joints.size(), numbers = plan.body.numbers.size();
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
    if (is_coded(*stage, plan)) break;
    std::vector<Vector> turns(pose.turns.size());
    std::vector<double> moves(pose.numbers.size());
    for (const Sample& sample : stage->samples) {
      for (std::size_t j = 0; j < joints; ++j) {
        const Quaternion predicted = predicted_turn(pose, plan.body, sample, j);
        const Vector rest =
            logarithm(product(conjugate(predicted), pose.turns[sample.frame * joints + j]));
        for (std::size_t i = 0; i < 2; ++i) {
          Vector& sum = turns[sample.from[i] * joints + j];
          for (std::size_t a = 0; a < 3; ++a) sum[a] += kShare * rest[a];
        }
      }
      for (std::size_t n = 0; n < numbers; ++n) {
        const double rest =
            pose.numbers[sample.frame * numbers + n] - predicted_number(pose, plan.body, sample, n);
        for (std::size_t i = 0; i < 2; ++i) moves[sample.from[i] * numbers + n] += kShare * rest;
      }
    }
    for (std::size_t i = 0; i < turns.size(); ++i) {
      pose.turns[i] = product(pose.turns[i], exponential(turns[i][0], turns[i][1], turns[i][2]));
    }
    for (std::size_t i = 0; i < moves.size(); ++i) pose.numbers[i] += moves[i];
  }
}

std::int64_t rounded(double steps, double rounding) {
  const auto magnitude = static_cast<std::int64_t>(std::fabs(steps) + rounding);
  return steps < 0 ? -magnitude : magnitude;
}

// A stage's samples as the sparse coder wants them, (samples, joints).
std::vector<Quaternion> residuals(const Pose& target, const Pose& known, const Stage& stage,
                                  const Plan& plan) {
  const std::size_t joints = plan.body.joints.size();
  std::vector<Quaternion> rest;
  rest.reserve(stage.samples.size() * joints);
  for (const Sample& sample : stage.samples) {
    for (std::size_t j = 0; j < joints; ++j) {
      rest.push_back(product(conjugate(predicted_turn(known, plan.body, sample, j)),
                             target.turns[sample.frame * joints + j]));
    }
  }
  return rest;
}

class Encoder {
 public:
  Encoder(const Plan& plan, const Effort& effort)
      : plan_(plan), effort_(effort), covered_(plan.body.joints.size()) {
    for (std::size_t i = 0; i < plan.parts.size(); ++i) {
      for (const double axis : plan.parts[i].axis) {
        logs_.push_back(axis * plan.parts[i].half_angle);
      }
      if (plan.parts[i].half_angle > 0) covered_[i % covered_.size()] = true;
    }
    for (const JointTurns& joint : plan.body.joints) importance_.push_back(joint.importance);
  }

  // Appends the symbols of a stage's samples, and puts the frames together.
  void code(const Stage& stage, const Pose& target, Pose& pose,
            std::vector<std::int64_t>& symbols) {
    const std::size_t joints = covered_.size(), count = stage.samples.size();
    const std::size_t size = plan_.atoms + plan_.body.columns;
    std::size_t at = symbols.size();
    symbols.resize(at + count * size);
    if (plan_.atoms > 0 && joints > 0) choose(residuals(target, pose, stage, plan_), count);
    for (std::size_t i = 0; i < count; ++i, at += size) {
      const Sample& sample = stage.samples[i];
      std::int64_t* const own = symbols.data() + at;
      for (std::size_t p = 0; plan_.atoms > 0 && joints > 0 && p < effort_.most; ++p) {
        const std::int32_t atom = atoms_[i * effort_.most + p];
        if (atom < 0) break;
        own[atom] = rounded(weights_[i * effort_.most + p] / plan_.step, 0.5);
      }
      put_together(sample, own, plan_, pose);
      bool more = false;
      for (std::size_t j = 0; j < joints; ++j) {
        const JointTurns& joint = plan_.body.joints[j];
        const Vector rest = logarithm(product(conjugate(pose.turns[sample.frame * joints + j]),
                                              target.turns[sample.frame * joints + j]));
        const double rounding = covered_[j] ? effort_.rest_rounding : effort_.rounding;
        for (std::size_t a = 0; a < joint.axes.size(); ++a) {
          const double steps = rest[joint.axes[a]] * joint.importance / plan_.step;
          own[plan_.atoms + joint.columns[a]] = rounded(steps, rounding);
          more = more || own[plan_.atoms + joint.columns[a]] != 0;
        }
      }
      for (std::size_t n = 0; n < plan_.body.numbers.size(); ++n) {
        const Number& number = plan_.body.numbers[n];
        const std::size_t place = sample.frame * plan_.body.numbers.size() + n;
        const double steps =
            (target.numbers[place] - pose.numbers[place]) * number.importance / plan_.step;
        own[plan_.atoms + number.column] = rounded(steps, effort_.rounding);
        more = more || own[plan_.atoms + number.column] != 0;
      }
      if (more) put_together(sample, own, plan_, pose);
    }
  }

 private:
  void choose(const std::vector<Quaternion>& rest, std::size_t count) {
    atoms_.assign(count * effort_.most, -1);
    weights_.assign(count * effort_.most, 0);
    const Frames frames = {rest.data()->data(), count, covered_.size(), importance_.data()};
    const Dictionary dictionary = {logs_.data(), plan_.atoms};
    const Weights weights = {atoms_.data(), weights_.data(), effort_.most};
    code_by_products(frames, dictionary, weights, {0, kLeast * plan_.step}, Order::sort);
    quantize_products(frames, dictionary, weights, plan_.step, effort_.rounding);
  }

  const Plan& plan_;
  const Effort& effort_;
  std::vector<bool> covered_;  // by atoms
  std::vector<double> logs_;
  std::vector<double> importance_;
  std::vector<std::int32_t> atoms_;
  std::vector<double> weights_;
};

Patches patches_of(const double* values, const std::vector<double>& decoded, std::size_t frames,
                   const Plan& plan, const double* max_errors) {
  const std::size_t columns = plan.body.columns;
  const auto most = limits_of(plan);
  Patches patches{std::vector<std::uint8_t>(frames * columns),
                  std::vector<std::int64_t>(frames * columns)};
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t f = 0; f < frames; ++f) {
      const double value = values[f * columns + c], near = decoded[f * columns + c];
      const double limit = max_errors[f * columns + c];
      if (std::fabs(value) <= most[c] && std::fabs(value - near) <= limit) continue;
      const std::size_t at = c * frames + f;
      const double steps = plan.patch > 0 ? (value - near) / plan.patch : kMostCorrections;
      const auto nearest =
          std::fabs(steps) < kMostCorrections ? rounded(steps, 0.5) : std::int64_t{0};
      const double corrected = near + static_cast<double>(nearest) * plan.patch;
      if (nearest != 0 && std::fabs(value - corrected) <= limit) {
        patches.kinds[at] = 1;
        patches.corrections[at] = nearest;
      } else {
        patches.kinds[at] = 2;
        patches.corrections[at] = std::bit_cast<std::int64_t>(value);
      }
    }
  }
  return patches;
}

// The symbols, and the frames that a decoder makes of them.
std::vector<std::int64_t> code_all(const double* values, std::size_t frames, const Plan& plan,
                                   const Effort& effort, Pose& pose) {
  const auto stages = stages_of(frames, plan.levels);
  Pose target = pose_of(values, frames, plan);
  update(target, stages, plan);
  Encoder encoder(plan, effort);
  const std::vector<std::int64_t> none(plan.atoms + plan.body.columns);
  std::vector<std::int64_t> symbols;
  for (const Stage& stage : stages) {
    if (is_coded(stage, plan)) {
      encoder.code(stage, target, pose, symbols);
    } else {
      for (const Sample& sample : stage.samples) put_together(sample, none.data(), plan, pose);
    }
  }
  return symbols;
}

}  // namespace

std::vector<std::int64_t> symbols_of(const double* values, std::size_t frames, const Plan& plan,
                                     const Effort& effort) {
  Pose pose(frames, plan.body);
  return code_all(values, frames, plan, effort, pose);
}

Bytes encode_chunk(const double* values, std::size_t frames, const Plan& plan, const Effort& effort,
                   const double* max_errors) {
  Pose pose(frames, plan.body);
  const auto symbols = code_all(values, frames, plan, effort, pose);
  std::vector<double> decoded(frames * plan.body.columns);
  write_rows(pose, frames, plan, decoded.data());
  return encode(symbols, frames, plan, patches_of(values, decoded, frames, plan, max_errors));
}

Pose pose_of(const double* values, std::size_t frames, const Plan& plan) {
  const auto clean = usable(values, frames, plan);
  const Body& body = plan.body;
  Pose pose(frames, body);
  for (std::size_t f = 0; f < frames; ++f) {
    const double* row = clean.data() + f * body.columns;
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
      pose.turns[f * body.joints.size() + j] = body.turn(body.joints[j], row);
    }
    for (std::size_t n = 0; n < body.numbers.size(); ++n) {
      pose.numbers[f * body.numbers.size() + n] = row[body.numbers[n].column];
    }
  }
  return pose;
}

std::vector<Quaternion> displacements(const double* values, std::size_t frames, const Plan& plan) {
  const auto stages = stages_of(frames, plan.levels);
  Pose pose = pose_of(values, frames, plan);
  update(pose, stages, plan);
  std::vector<Quaternion> all;
  for (const Stage& stage : stages) {
    if (!is_coded(stage, plan)) break;
    const auto some = residuals(pose, pose, stage, plan);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::vector<std::size_t> kinds_of(std::size_t frames, const Plan& plan) {
  std::vector<std::size_t> kinds;
  for (const Stage& stage : stages_of(frames, plan.levels)) {
    if (is_coded(stage, plan)) kinds.insert(kinds.end(), stage.samples.size(), stage.kind);
  }
  return kinds;
}

}  // namespace mocapress::qssd
