#include "exact/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coding/fail.hpp"
#include "numbers/arithmetic.hpp"

namespace mocapress::exact {
namespace {

constexpr double kFarthest = 1e5;  // degrees and lengths; numbers beyond are taken for this
constexpr double kLeast = 1e-12;   // of a channel's precision

// `m` after a turn about one of its own axes.
void turn(Matrix& m, std::size_t axis, double degrees) {
  const auto [sine, cosine] = sine_cosine(degrees * kRadiansPerDegree);
  Vector& next = m[(axis + 1) % 3];
  Vector& last = m[(axis + 2) % 3];
  const Vector moved = sum(scaled(next, cosine), scaled(last, sine));
  last = sum(scaled(last, cosine), scaled(next, -sine));
  next = moved;
}

// The turn from one frame to another, about its axis, by the sine of its angle.
Vector turn_between(const Matrix& from, const Matrix& to) {
  return scaled(sum(sum(cross(from[0], to[0]), cross(from[1], to[1])), cross(from[2], to[2])), 0.5);
}

double bounded(double number) {
  return number > -kFarthest ? std::min(number, kFarthest) : -kFarthest;
}

bool moves(int bone, int other) {
  while (other > bone) other = kCmu.bones[static_cast<std::size_t>(other)].parent;
  return other == bone;
}

}  // namespace

Kinematics::Kinematics(std::span<const Column> columns) : channel_of_(columns.size(), -1) {
  std::array<bool, kSkeletonChannels> taken{};
  std::size_t size = 0;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].place < 0) continue;
    const auto place = static_cast<std::size_t>(columns[c].place);
    if (place >= kSkeletonChannels || std::exchange(taken[place], true)) {
      fail("a place that the skeleton does not have");
    }
    const int bone = kCmu.channels[place].bone;
    Channel channel{
        c, std::ldexp(1.0, columns[c].exponent), place, static_cast<std::size_t>(bone), {}, size};
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (!moves(static_cast<int>(channels_[i].bone), bone)) continue;
      if (channels_[i].before.size() != channel.before.size()) {
        fail("a channel stands before those of the joint's parent");
      }
      channel.before.push_back(i);
    }
    size += channel.before.size() + 1;
    channel_of_[c] = static_cast<int>(channels_.size());
    channels_.push_back(std::move(channel));
  }
  matrix_.resize(size);
  pushes_.resize(channels_.size());
  for (std::size_t b = 0; b < kBones; ++b) {
    axes_[b] = kIdentity;
    for (const std::size_t axis : {2, 1, 0}) turn(axes_[b], axis, kCmu.bones[b].axis[axis]);
  }
}

void Kinematics::begin(const Frames& frames) {
  Numbers earlier{};
  Numbers last{};
  Numbers next{};
  for (const Channel& channel : channels_) {
    const double level = frames.level(channel.column, 1);
    const double move = frames.difference(channel.column, 1, 1);
    earlier[channel.place] = bounded((level - move) / channel.unit);
    last[channel.place] = bounded(level / channel.unit);
    next[channel.place] = bounded((level + move) / channel.unit);
  }
  stand(earlier, earlier_);
  stand(last, last_);
  stand(next, expected_);
  weigh();
  fill();
  factor();
}

// Bones, and how the channels move them, which is told by the pose that is taken last.
void Kinematics::stand(const Numbers& numbers, Pose& pose) {
  for (std::size_t b = 0; b < kBones; ++b) {
    const SkeletonBone& bone = kCmu.bones[b];
    Matrix frame = axes_[b];
    Vector start{};
    if (bone.parent >= 0) {
      const auto parent = static_cast<std::size_t>(bone.parent);
      frame = product(pose.turns[parent], frame);
      start = sum(pose.starts[parent], turned(pose.turns[parent], bone.start));
    }
    for (std::size_t kind = 6; kind-- > 0;) {
      if (bone.channels[kind] < 0) continue;
      const auto place = static_cast<std::size_t>(bone.channels[kind]);
      const std::size_t axis = kind % 3;
      Twist& twist = twists_[place];
      if (kind < 3) {
        twist = {};
        twist.linear[axis] = 1;
        continue;
      }
      twist.angular = scaled(frame[axis], kRadiansPerDegree);
      twist.linear = cross(start, twist.angular);
      turn(frame, axis, numbers[place]);
    }
    pose.starts[b] = start;
    pose.turns[b] = product(frame, transposed(axes_[b]));
    pose.ends[b] = sum(start, turned(pose.turns[b], bone.end));
  }
}

// Every bone with all that hangs on it. It is pushed to where its end, and its frame, were going.
void Kinematics::weigh() {
  for (std::size_t b = 0; b < kBones; ++b) {
    const double mass = kCmu.bones[b].mass;
    const double inertia = kCmu.bones[b].inertia;
    const Vector& end = expected_.ends[b];
    const double square = dot(end, end);
    const Vector going = sum(scaled(last_.ends[b], 2), scaled(earlier_.ends[b], -1));
    const Vector force = scaled(sum(going, scaled(end, -1)), mass);
    const Matrix turning =
        product(last_.turns[b], product(transposed(earlier_.turns[b]), last_.turns[b]));
    const Vector torque =
        sum(cross(end, force), scaled(turn_between(expected_.turns[b], turning), inertia));
    bodies_[b] = {
        mass,
        scaled(end, mass),
        {mass * (square - end[0] * end[0]) + inertia, mass * (square - end[1] * end[1]) + inertia,
         mass * (square - end[2] * end[2]) + inertia, -mass * end[0] * end[1],
         -mass * end[0] * end[2], -mass * end[1] * end[2]},
        force,
        torque};
  }
  for (std::size_t b = kBones; b-- > 1;) {
    Body& whole = bodies_[static_cast<std::size_t>(kCmu.bones[b].parent)];
    const Body& part = bodies_[b];
    whole.mass += part.mass;
    whole.moment = sum(whole.moment, part.moment);
    for (std::size_t i = 0; i < part.tensor.size(); ++i) whole.tensor[i] += part.tensor[i];
    whole.force = sum(whole.force, part.force);
    whole.torque = sum(whole.torque, part.torque);
  }
}

// The mass matrix: what moves with the later of two channels, by how both move it.
void Kinematics::fill() {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    const Channel& channel = channels_[k];
    const Twist& own = twists_[channel.place];
    const Body& body = bodies_[channel.bone];
    const auto& t = body.tensor;
    const Vector& w = own.angular;
    const Vector linear = sum(scaled(own.linear, body.mass), cross(w, body.moment));
    const Vector angular =
        sum(cross(body.moment, own.linear),
            {t[0] * w[0] + t[3] * w[1] + t[4] * w[2], t[3] * w[0] + t[1] * w[1] + t[5] * w[2],
             t[4] * w[0] + t[5] * w[1] + t[2] * w[2]});
    double* row = matrix_.data() + channel.row;
    for (const std::size_t before : channel.before) {
      const Twist& twist = twists_[channels_[before].place];
      *row++ = dot(twist.linear, linear) + dot(twist.angular, angular);
    }
    *row = dot(own.linear, linear) + dot(w, angular) + kCmu.channels[channel.place].resistance;
    pushes_[k] = dot(own.linear, body.force) + dot(w, body.torque);
  }
}

// The last channel first: its row becomes its regression on those before it, its push its mean
// where they do not leave their way. No entry appears that was not there.
void Kinematics::factor() {
  for (std::size_t k = channels_.size(); k-- > 0;) {
    const Channel& channel = channels_[k];
    double* row = matrix_.data() + channel.row;
    const std::size_t count = channel.before.size();
    const double precision = std::max(row[count], kLeast);
    pushes_[k] /= precision;
    for (std::size_t i = 0; i < count; ++i) {
      double* earlier = matrix_.data() + channels_[channel.before[i]].row;
      const double share = row[i] / precision;
      for (std::size_t j = 0; j <= i; ++j) earlier[j] -= share * row[j];
      pushes_[channel.before[i]] -= row[i] * pushes_[k];
    }
    for (std::size_t i = 0; i < count; ++i) row[i] /= precision;
  }
}

double Kinematics::guess(std::size_t column, const Frames& frames) const {
  if (channel_of_[column] < 0) return 0;
  const auto k = static_cast<std::size_t>(channel_of_[column]);
  const double* row = matrix_.data() + channels_[k].row;
  double mean = pushes_[k];
  for (const std::size_t before : channels_[k].before) {
    const Channel& known = channels_[before];
    mean -= *row++ * bounded(frames.difference(known.column, 2, 0) / known.unit);
  }
  return bounded(mean) * channels_[k].unit;
}

}  // namespace mocapress::exact
