#include "qssd/codec.hpp"

#include <bit>
#include <cmath>
#include <optional>

#include "coding/fail.hpp"
#include "coding/sides.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// As in core/motion/kinematics.cpp: no fused operations of sums and differences side by side.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::qssd {
namespace {

constexpr double kAtomSteps = 128;  // of an atom's length of 1

bool is_coded(const Stage& stage, const Plan& plan) { return stage.stride >> plan.omitted != 0; }

// Weights of atoms in the order of their product: the largest first, of equal ones the first atom.
struct Weighted {
  std::size_t atom;
  std::int64_t weight;
};

template <class Side>
void code_patches(Side& side, std::size_t frames, std::size_t columns, double patch,
                  Patches* patches, double* values) {
  std::array<Counted, 2> kinds;
  Difference<6> differences;
  Counted any, of_column;
  if (!any.code(side, patches != nullptr)) return;
  for (std::size_t c = 0; c < columns; ++c) {
    bool some = false;
    if (patches != nullptr) {
      const auto first = patches->kinds.begin() + static_cast<std::ptrdiff_t>(c * frames);
      some = std::any_of(first, first + static_cast<std::ptrdiff_t>(frames),
                         [](std::uint8_t kind) { return kind != 0; });
    }
    if (!of_column.code(side, some)) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      const std::uint8_t kind = patches == nullptr ? 0 : patches->kinds[c * frames + f];
      const std::int64_t own = patches == nullptr ? 0 : patches->corrections[c * frames + f];
      if (!kinds[0].code(side, kind != 0)) continue;
      if (!kinds[1].code(side, kind == 2)) {
        const std::int64_t steps = differences.code(side, own);
        if (values != nullptr) values[f * columns + c] += static_cast<double>(steps) * patch;
      } else {
        const auto bits = side.raw(64, static_cast<std::uint64_t>(own));
        if (values != nullptr) values[f * columns + c] = std::bit_cast<double>(bits);
      }
    }
    if constexpr (Side::kReading) {
      if (!side.sound()) fail("a payload that is cut off");
    }
  }
}

}  // namespace

Plan read_plan(ByteView header, ByteView model, std::size_t columns) {
  Plan plan;
  Record record(header);
  const bool learned = record.integer(1) != 0;
  plan.levels = static_cast<int>(record.integer(kMostLevels));
  plan.omitted = static_cast<int>(record.integer(static_cast<std::uint64_t>(plan.levels)));
  plan.step = record.number();
  plan.patch = record.number();
  if (!(plan.step > 0 && plan.step < 1e9) || !(plan.patch >= 0)) fail("steps that are no numbers");
  if (!learned) {
    plan.body = read_body(record);
  } else {
    if (model.empty()) fail("the clip was coded with a model");
    Record own(model);
    plan.body = read_body(own);
    plan.atoms = own.integer(4096);
    const std::size_t joints = plan.body.joints.size();
    if (joints > 0 && plan.atoms > own.left() / joints) fail("more atoms than a model holds");
    plan.parts.resize(plan.atoms * joints);
    for (std::size_t i = 0; i < plan.parts.size(); ++i) {
      const double scale = kAtomSteps * plan.body.joints[i % joints].importance;
      Part& part = plan.parts[i];
      for (double& axis : part.axis) {
        const std::int64_t whole = own.signed_integer();
        if (whole < -256 || whole > 256) fail("an atom that is too long");
        axis = static_cast<double>(whole) / scale;
      }
      part.half_angle = length(part.axis[0], part.axis[1], part.axis[2]);
      if (part.half_angle > 0) {
        for (double& axis : part.axis) axis /= part.half_angle;
      }
    }
    const ByteView chances = own.bytes();
    plan.chances.assign(chances.begin(), chances.end());
    own.end();
  }
  record.end();
  if (plan.body.columns != columns) fail("a header of other columns");
  return plan;
}

void put_together(const Sample& sample, const std::int64_t* symbols, const Plan& plan, Pose& pose) {
  const std::size_t joints = plan.body.joints.size();
  std::vector<Weighted> weights;
  for (std::size_t a = 0; a < plan.atoms; ++a) {
    if (symbols[a] != 0) weights.push_back({a, symbols[a]});
  }
  const auto magnitude = [](const Weighted& w) { return w.weight < 0 ? -w.weight : w.weight; };
  std::stable_sort(weights.begin(), weights.end(),
                   [&](const auto& a, const auto& b) { return magnitude(a) > magnitude(b); });
  const std::int64_t* own = symbols + plan.atoms;
  for (std::size_t j = 0; j < joints; ++j) {
    const JointTurns& joint = plan.body.joints[j];
    Quaternion turn = predicted_turn(pose, plan.body, sample, j);
    for (const auto& [atom, weight] : weights) {
      const Part& part = plan.parts[atom * joints + j];
      if (part.half_angle == 0) continue;
      const double half = static_cast<double>(weight) * plan.step * part.half_angle;
      turn = product(turn, about(part.axis, half));
    }
    std::array<double, 3> rest{};
    for (std::size_t i = 0; i < joint.axes.size(); ++i) {
      rest[joint.axes[i]] =
          static_cast<double>(own[joint.columns[i]]) * plan.step / joint.importance;
    }
    if (rest[0] != 0 || rest[1] != 0 || rest[2] != 0) {
      turn = product(turn, exponential(rest[0], rest[1], rest[2]));
    }
    pose.turns[sample.frame * joints + j] = turn;
  }
  for (std::size_t n = 0; n < plan.body.numbers.size(); ++n) {
    const Number& number = plan.body.numbers[n];
    const double more = static_cast<double>(own[number.column]) * plan.step / number.importance;
    pose.numbers[sample.frame * plan.body.numbers.size() + n] =
        predicted_number(pose, plan.body, sample, n) + more;
  }
}

void write_rows(const Pose& pose, std::size_t frames, const Plan& plan, double* values) {
  const Body& body = plan.body;
  for (std::size_t f = 0; f < frames; ++f) {
    double* const row = values + f * body.columns;
    const double* const before = f == 0 ? nullptr : row - body.columns;
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
      body.angles(body.joints[j], pose.turns[f * body.joints.size() + j], before, row);
    }
    for (std::size_t n = 0; n < body.numbers.size(); ++n) {
      row[body.numbers[n].column] = pose.numbers[f * body.numbers.size() + n];
    }
  }
}

void decode(ByteView payload, double* values, std::size_t frames, const Plan& plan) {
  RangeReading side(payload);
  Symbols coder(plan.atoms, plan.body.columns, plan.chances);
  std::vector<std::int64_t> symbols(coder.count());
  Pose pose(frames, plan.body);
  for (const Stage& stage : stages_of(frames, plan.levels)) {
    const bool coded = is_coded(stage, plan);
    for (const Sample& sample : stage.samples) {
      for (std::size_t s = 0; coded && s < symbols.size(); ++s) {
        symbols[s] = coder.code(side, stage.kind, s, 0);
      }
      if (!coded) std::fill(symbols.begin(), symbols.end(), 0);
      if (!side.sound()) fail("a payload that is cut off");
      put_together(sample, symbols.data(), plan, pose);
    }
  }
  write_rows(pose, frames, plan, values);
  code_patches(side, frames, plan.body.columns, plan.patch, nullptr, values);
  if (!side.exhausted()) fail("a payload that does not end where it should");
}

Bytes encode(std::span<const std::int64_t> symbols, std::size_t frames, const Plan& plan,
             const Patches& patches) {
  RangeWriting side;
  Symbols coder(plan.atoms, plan.body.columns, plan.chances);
  const std::int64_t* next = symbols.data();
  for (const Stage& stage : stages_of(frames, plan.levels)) {
    if (!is_coded(stage, plan)) continue;
    for (std::size_t i = 0; i < stage.samples.size(); ++i) {
      for (std::size_t s = 0; s < coder.count(); ++s) coder.code(side, stage.kind, s, *next++);
    }
  }
  const bool any = std::any_of(patches.kinds.begin(), patches.kinds.end(),
                               [](std::uint8_t kind) { return kind != 0; });
  Patches own = any ? patches : Patches{};
  code_patches(side, frames, plan.body.columns, plan.patch, any ? &own : nullptr, nullptr);
  return side.finish();
}

}  // namespace mocapress::qssd
