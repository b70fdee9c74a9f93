#include "near_encoding/leverage.hpp"

#include <algorithm>
#include <cmath>

#include "motion/angle.hpp"
#include "numbers/arithmetic.hpp"

namespace mocapress::near {
namespace {

// Above so many channels of joints, errors of others are not made good: that takes their square.
constexpr std::size_t kMostShaped = 768;
// Of the diagonal, so that what can hardly be told apart is not made good by large errors.
constexpr double kRidge = 1.003;
constexpr double kLeast = 1e-9;

// The joint's axes in space, of a turn.
Matrix axes_of(const double* q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

Vector at(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

}  // namespace

void Measure::errors(const double* row, const double* other, std::size_t channels,
                     double* errors) const {
  if (!rig) {
    for (std::size_t c = 0; c < channels; ++c) {
      errors[c] = std::fabs(row[c] - other[c]) * others[c];
    }
    return;
  }
  thread_local std::vector<double> places[2], turns[2];
  for (auto& one : places) one.resize(3 * rig->points());
  for (auto& one : turns) one.resize(4 * rig->joints());
  rig->place(row, places[0].data(), turns[0].data());
  rig->place(other, places[1].data(), turns[1].data());
  for (std::size_t j = 0; j < rig->joints(); ++j) {
    const Matrix one = axes_of(&turns[0][4 * j]), two = axes_of(&turns[1][4 * j]);
    const Vector away = sum(at(&places[0][3 * j]), scaled(at(&places[1][3 * j]), -1));
    double most = dot(away, away);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector apart = sum(away, scaled(sum(one[k], scaled(two[k], -1)), radius));
      most = std::max(most, dot(apart, apart));
    }
    errors[j] = std::sqrt(most);
  }
}

std::vector<Vector> Measure::places(const double* row) const {
  std::vector<double> joints(3 * rig->points()), turns(4 * rig->joints());
  rig->place(row, joints.data(), turns.data());
  std::vector<Vector> found;
  for (std::size_t j = 0; j < rig->joints(); ++j) {
    const Vector place = found.emplace_back(at(&joints[3 * j]));
    for (const Vector& axis : axes_of(&turns[4 * j])) {
      found.push_back(sum(place, scaled(axis, radius)));
    }
  }
  return found;
}

Leverage::Leverage(const Measure& measure, std::size_t channels, std::vector<double> weights,
                   std::vector<bool> moves)
    : measure_(measure), channels_(channels), weights_(std::move(weights)), before_(channels) {
  begins_.resize(channels);
  if (!measure.rig) return;
  const Rig& rig = *measure.rig;
  for (const auto& action : rig.actions()) {
    if (moves[action.column]) actions_.push_back(action);
  }
  const auto above = [&](std::size_t joint, std::size_t other) {
    auto j = static_cast<std::int32_t>(joint);
    while (j > static_cast<std::int32_t>(other)) j = rig.parent(static_cast<std::size_t>(j));
    return j == static_cast<std::int32_t>(other);
  };
  earlier_.resize(actions_.size());
  for (std::size_t a = 0; a < actions_.size(); ++a) {
    begins_[actions_[a].column] = pairs_;
    for (std::size_t b = 0; b < a && actions_.size() <= kMostShaped; ++b) {
      const std::size_t i = actions_[a].joint, j = actions_[b].joint;
      if (!above(std::max(i, j), std::min(i, j))) continue;
      earlier_[a].push_back(b);
      before_[actions_[a].column].push_back(actions_[b].column);
      ++pairs_;
    }
  }
  directions_.resize(actions_.size());
  zeroth_.resize(rig.joints());
  first_.resize(rig.joints());
  second_.resize(rig.joints());
  places_.resize(rig.joints());
  joint_places_.resize(3 * rig.points());
  joint_turns_.resize(4 * rig.joints());
  if (actions_.size() <= kMostShaped) matrix_.resize(actions_.size() * actions_.size());
}

// Weight, place and products of places of the points at and below every joint.
void Leverage::gather(const double* row) {
  const Rig& rig = *measure_.rig;
  rig.place(row, joint_places_.data(), joint_turns_.data());
  rig.direct(actions_, row, joint_turns_.data(), directions_.data());
  if (!measure_.radians) {
    for (std::size_t a = 0; a < actions_.size(); ++a) {
      if (actions_[a].turns) directions_[a] = scaled(directions_[a], kRadiansPerDegree);
    }
  }
  const Vector origin = scaled(at(joint_places_.data()), -1);
  for (std::size_t j = 0; j < rig.joints(); ++j) {
    places_[j] = sum(at(&joint_places_[3 * j]), origin);
    const Matrix axes = axes_of(&joint_turns_[4 * j]);
    zeroth_[j] = weights_[j];
    first_[j] = {};
    second_[j] = {};
    for (const Vector& axis : axes) {
      const Vector point = sum(places_[j], scaled(axis, measure_.radius));
      const double weight = weights_[j] / 3;
      first_[j] = sum(first_[j], scaled(point, weight));
      for (std::size_t k = 0; k < 3; ++k) {
        second_[j][k] = sum(second_[j][k], scaled(point, weight * point[k]));
      }
    }
  }
  for (std::size_t j = rig.joints(); j-- > 0;) {
    if (rig.parent(j) < 0) continue;
    const auto parent = static_cast<std::size_t>(rig.parent(j));
    zeroth_[parent] += zeroth_[j];
    first_[parent] = sum(first_[parent], first_[j]);
    for (std::size_t k = 0; k < 3; ++k) {
      second_[parent][k] = sum(second_[parent][k], second_[j][k]);
    }
  }
}

// The product of what two actions do, summed over the points that both move.
double Leverage::pair(std::size_t a, std::size_t b) const {
  const auto& one = actions_[a];
  const auto& two = actions_[b];
  const std::size_t joint = std::max(one.joint, two.joint);
  const Vector &d = directions_[a], &e = directions_[b];
  const double weight = zeroth_[joint];
  const Vector& first = first_[joint];
  const Matrix& second = second_[joint];
  if (!one.turns && !two.turns) return weight * dot(d, e);
  if (!one.turns || !two.turns) {
    const Vector& along = one.turns ? e : d;
    const Vector& about = one.turns ? d : e;
    const Vector& pivot = places_[one.turns ? one.joint : two.joint];
    return dot(along, cross(about, sum(first, scaled(pivot, -weight))));
  }
  const Vector &p = places_[one.joint], &q = places_[two.joint];
  const double trace = second[0][0] + second[1][1] + second[2][2];
  const double products = trace - dot(sum(p, q), first) + weight * dot(p, q);
  const double crossed = dot(d, turned(second, e)) - dot(d, q) * dot(first, e) -
                         dot(d, first) * dot(p, e) + weight * dot(d, q) * dot(p, e);
  return dot(d, e) * products - crossed;
}

void Leverage::of_frame(const double* row, double* costs, float* shares) {
  for (std::size_t c = 0; c < channels_; ++c) costs[c] = measure_.others[c] * measure_.others[c];
  if (actions_.empty()) return;
  gather(row);
  const std::size_t count = actions_.size();
  if (matrix_.empty()) {
    for (std::size_t a = 0; a < count; ++a) costs[actions_[a].column] = pair(a, a) + kLeast;
    return;
  }
  const auto entry = [&](std::size_t a, std::size_t b) -> double& {
    return matrix_[std::max(a, b) * count + std::min(a, b)];
  };
  for (std::size_t a = 0; a < count; ++a) {
    entry(a, a) = pair(a, a) * kRidge + kLeast;
    for (const std::size_t b : earlier_[a]) entry(a, b) = pair(a, b);
  }
  // The last channel makes good what it can, then the one before it, and so on.
  for (std::size_t a = count; a-- > 0;) {
    const double cost = std::max(entry(a, a), kLeast);
    costs[actions_[a].column] = cost;
    float* share = shares + begins_[actions_[a].column];
    for (const std::size_t b : earlier_[a]) {
      const double part = entry(a, b) / cost;
      *share++ = static_cast<float>(part);
      for (const std::size_t c : earlier_[a]) {
        if (c > b) break;
        entry(b, c) -= part * entry(a, c);
      }
    }
  }
}

}  // namespace mocapress::near
