#include "motion/kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "motion/angle.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// g++ 12.2 makes fused operations of sums and differences of products that it finds side by side,
// though -ffp-contract=off forbids them.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress {
namespace {

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Vector turned(const Quaternion& turn, const Vector& vector) {
  const Vector axis = {turn[1], turn[2], turn[3]};
  const Vector twice = scaled(cross(axis, vector), 2);
  return sum(sum(vector, scaled(twice, turn[0])), cross(axis, twice));
}

Quaternion about(std::size_t axis, double angle, bool radians) {
  const auto [sine, cosine] = radians ? turn_of_radians(angle / 2) : turn_of_degrees(angle / 2);
  Quaternion turn = {cosine, 0, 0, 0};
  turn[1 + axis] = sine;
  return turn;
}

// C: the rotation of an ASF bone's axis.
Quaternion frame_of(const Joint& joint, bool radians) {
  Quaternion frame = {1, 0, 0, 0};
  for (auto axis = joint.axis_order.rbegin(); axis != joint.axis_order.rend(); ++axis) {
    const auto index = static_cast<std::size_t>(*axis - 'x');
    frame = product(frame, about(index, joint.axis[index], radians));
  }
  return frame;
}

}  // namespace

Rig::Rig(const Skeleton& skeleton, const std::vector<ChannelPlace>& columns, bool radians)
    : fixed_(skeleton.fixed), radians_(radians) {
  const std::size_t count = skeleton.joints.size();
  std::vector<std::vector<std::size_t>> own(count);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto joint = static_cast<std::size_t>(columns[c].joint);
    if (columns[c].joint >= 0 && joint < count) own[joint].push_back(c);
  }
  for (std::size_t j = 0; j < count; ++j) {
    const Joint& joint = skeleton.joints[j];
    Move move;
    move.parent = joint.parent;
    move.offset = joint.offset;
    for (const Kind kind : joint.channels) {
      // The n-th channel of a kind is the n-th such column.
      const auto found = std::find_if(own[j].begin(), own[j].end(),
                                      [&](std::size_t c) { return columns[c].kind == kind; });
      if (found == own[j].end()) continue;
      if (is_translation(kind)) move.along[axis_of(kind)] = static_cast<std::int64_t>(*found);
      if (is_rotation(kind)) move.turns.push_back({*found, axis_of(kind)});
      if (kind == Kind::stretch) stretching_.push_back(*found);
      own[j].erase(found);
    }
    if (fixed_) {
      const auto rank = [&](const Rotation& turn) {
        return joint.axis_order.find(static_cast<char>('x' + turn.axis));
      };
      std::stable_sort(move.turns.begin(), move.turns.end(),
                       [&](const auto& a, const auto& b) { return rank(a) > rank(b); });
    }
    move.framed = joint.axis[0] != 0 || joint.axis[1] != 0 || joint.axis[2] != 0;
    if (move.framed) move.frame = frame_of(joint, skeleton.radians);
    moves_.push_back(std::move(move));
    for (const Vector& end : joint.ends) ends_.push_back({static_cast<std::int32_t>(j), end});
  }
}

bool Rig::stretches(const double* row) const {
  return std::any_of(stretching_.begin(), stretching_.end(),
                     [&](std::size_t c) { return row[c] != 0; });
}

std::vector<Rig::Action> Rig::actions() const {
  std::vector<Action> found;
  for (std::size_t j = 0; j < moves_.size(); ++j) {
    for (const std::int64_t column : moves_[j].along) {
      if (column >= 0) found.push_back({static_cast<std::size_t>(column), j, false});
    }
    for (const auto& [column, axis] : moves_[j].turns) found.push_back({column, j, true});
  }
  std::sort(found.begin(), found.end(),
            [](const Action& a, const Action& b) { return a.column < b.column; });
  return found;
}

void Rig::direct(const std::vector<Action>& actions, const double* row, const double* turns,
                 Vector* directions) const {
  for (std::size_t a = 0; a < actions.size(); ++a) {
    const auto& [column, joint, turning] = actions[a];
    const Move& move = moves_[joint];
    Quaternion turn = {1, 0, 0, 0};
    if (move.parent >= 0)
      std::copy_n(turns + 4 * static_cast<std::ptrdiff_t>(move.parent), 4, turn.begin());
    std::size_t axis = 0;
    if (turning) {
      if (move.framed) turn = product(turn, move.frame);
      for (const auto& [other, about_axis] : move.turns) {
        axis = about_axis;
        if (other == column) break;
        turn = product(turn, about(axis, row[other], radians_));
      }
    } else {
      while (move.along[axis] != static_cast<std::int64_t>(column)) ++axis;
    }
    Vector unit{};
    unit[axis] = 1;
    directions[a] = turned(turn, unit);
  }
}

Vector Rig::local_place(const Move& move, const double* row) const {
  Vector place = move.offset;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (move.along[axis] < 0) continue;
    const double value = row[move.along[axis]];
    place[axis] = fixed_ ? place[axis] + value : value;
  }
  return place;
}

Quaternion Rig::local_turn(const Move& move, const double* row) const {
  Quaternion turn = {1, 0, 0, 0};
  for (std::size_t k = 0; k < move.turns.size(); ++k) {
    const auto [column, axis] = move.turns[k];
    const Quaternion one = about(axis, row[column], radians_);
    turn = k == 0 ? one : product(turn, one);
  }
  if (!move.framed) return turn;
  const Quaternion& frame = move.frame;
  return product(product(frame, turn), {frame[0], -frame[1], -frame[2], -frame[3]});
}

void Rig::place_locally(const double* row, double* places, double* turns) const {
  for (const Move& move : moves_) {
    places = std::copy_n(local_place(move, row).begin(), 3, places);
    turns = std::copy_n(local_turn(move, row).begin(), 4, turns);
  }
}

void Rig::place(const double* row, double* places, double* turns) const {
  const auto put = [&](std::size_t point, std::size_t parent, const Vector& at) {
    Quaternion turn;
    Vector from;
    std::copy_n(turns + 4 * parent, 4, turn.begin());
    std::copy_n(places + 3 * parent, 3, from.begin());
    std::copy_n(sum(from, turned(turn, at)).begin(), 3, places + 3 * point);
    return turn;
  };
  for (std::size_t j = 0; j < moves_.size(); ++j) {
    const Move& move = moves_[j];
    const Vector at = local_place(move, row);
    Quaternion turn = local_turn(move, row);
    if (move.parent < 0) {
      std::copy_n(at.begin(), 3, places + 3 * j);
    } else {
      turn = product(put(j, static_cast<std::size_t>(move.parent), at), turn);
    }
    std::copy_n(turn.begin(), 4, turns + 4 * j);
  }
  for (std::size_t e = 0; e < ends_.size(); ++e)
    put(joints() + e, static_cast<std::size_t>(ends_[e].joint), ends_[e].at);
}

}  // namespace mocapress
