#include "qssd/body.hpp"

#include <cmath>

#include "coding/fail.hpp"

namespace mocapress::qssd {
namespace {

constexpr std::uint64_t kMostColumns = std::uint64_t{1} << 18;
constexpr double kDegree = 0.017453292519943295;

// The three axes of a joint's product from left to right; those that it lacks stand behind.
std::array<std::size_t, 3> axes_of(const JointTurns& joint, bool reversed) {
  std::array<std::size_t, 3> axes{};
  const std::size_t count = joint.axes.size();
  std::size_t left = 3;  // of 0 + 1 + 2
  for (std::size_t i = 0; i < count; ++i) {
    axes[i] = joint.axes[reversed ? count - 1 - i : i];
    left -= axes[i];
  }
  if (count == 2) axes[2] = left;
  if (count == 1) {
    axes[1] = (axes[0] + 1) % 3;
    axes[2] = (axes[0] + 2) % 3;
  }
  return axes;
}

double whole_turns(double degrees) { return 360 * std::floor(degrees / 360 + 0.5); }

}  // namespace

Quaternion Body::turn(const JointTurns& joint, const double* row) const {
  Quaternion made = kNoTurn;
  const std::size_t count = joint.axes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = reversed ? count - 1 - i : i;
    const double angle = row[joint.columns[at]] / 2;
    const Turn turn = radians ? turn_of_radians(angle) : turn_of_degrees(angle);
    Quaternion one = {turn.cosine, 0, 0, 0};
    one[1 + joint.axes[at]] = turn.sine;
    made = i == 0 ? one : product(made, one);
  }
  return made;
}

void Body::angles(const JointTurns& joint, const Quaternion& q, const double* before,
                  double* row) const {
  const auto [i, j, k] = axes_of(joint, reversed);
  const double w = q[0], a = q[1 + i], b = q[1 + j], c = q[1 + k];
  const std::size_t count = joint.axes.size();
  std::array<double, 3> found{};
  if (count == 1) {
    found[0] = 2 * angle_of(a, w);
  } else {
    const double even = (i + 1) % 3 == j ? 1 : -1;  // the axes are x, y, z, or begin elsewhere
    const double sine = std::clamp(2 * (w * b + even * a * c), -1.0, 1.0);
    found[1] = angle_of(sine, std::sqrt(1 - sine * sine));
    if (std::fabs(sine) > 1 - 1e-14) {
      found[0] = 2 * angle_of(a, w);  // the outer two turn about one axis
    } else {
      found[0] = angle_of(2 * (w * a - even * b * c), w * w - a * a - b * b + c * c);
      found[2] = angle_of(2 * (w * c - even * a * b), w * w + a * a - b * b - c * c);
    }
  }
  const double unit = radians ? kDegree : 1;
  std::array<double, 3> twin = {found[0] / kDegree + 180, 180 - found[1] / kDegree,
                                found[2] / kDegree + 180};
  double own_way = 0, twin_way = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double near =
        before == nullptr ? 0 : before[joint.columns[reversed ? count - 1 - n : n]] / unit;
    found[n] /= kDegree;
    found[n] -= whole_turns(found[n] - near);
    twin[n] -= whole_turns(twin[n] - near);
    own_way += std::fabs(found[n] - near);
    twin_way += std::fabs(twin[n] - near);
  }
  const auto& chosen = count == 3 && before != nullptr && twin_way < own_way ? twin : found;
  for (std::size_t n = 0; n < count; ++n) {
    row[joint.columns[reversed ? count - 1 - n : n]] = chosen[n] * unit;
  }
}

Body read_body(Record& record) {
  Body body;
  body.columns = record.integer(kMostColumns);
  const auto roles = record.runs(body.columns, 6);
  for (std::size_t c = 0; c < body.columns; ++c) {
    if (roles[c] == 0) {
      body.numbers.push_back({c});
      continue;
    }
    const bool more = roles[c] > 3;
    const std::size_t axis = (roles[c] - 1) % 3;
    if (!more) body.joints.emplace_back();
    if (c == 0 ? more : more && roles[c - 1] == 0) fail("a joint that does not begin");
    JointTurns& joint = body.joints.back();
    if (std::find(joint.axes.begin(), joint.axes.end(), axis) != joint.axes.end()) {
      fail("a joint that turns twice about an axis");
    }
    joint.columns.push_back(c);
    joint.axes.push_back(axis);
  }
  const std::uint64_t flags = record.integer(3);
  body.reversed = (flags & 1) != 0;
  body.radians = (flags & 2) != 0;
  for (JointTurns& joint : body.joints) {
    joint.importance = static_cast<double>(record.integer(1 << 20)) / 16;
    if (joint.importance == 0) fail("a joint of no importance");
    double squares = 0;
    for (double& part : joint.reference) {
      const std::int64_t whole = record.signed_integer();
      if (whole < -4096 || whole > 4096) fail("a reference that is no turn");
      part = static_cast<double>(whole);
      squares += part * part;
    }
    if (squares == 0) fail("a reference that is no turn");
    const double size = std::sqrt(squares);
    for (double& part : joint.reference) part /= size;
  }
  const auto facts = record.numbers(2 * body.numbers.size());
  for (std::size_t n = 0; n < body.numbers.size(); ++n) {
    body.numbers[n].importance = facts[2 * n];
    body.numbers[n].reference = facts[2 * n + 1];
    if (!(facts[2 * n] > 0 && facts[2 * n] < 1e9) || !(std::fabs(facts[2 * n + 1]) < 1e15)) {
      fail("a number of no importance");
    }
  }
  return body;
}

}  // namespace mocapress::qssd
