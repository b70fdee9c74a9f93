// Forward kinematics: from channels to places and turns in space. The conventions are those of
// docs/decisions/002-kinematics.md; positions have the same bits from every build.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "motion/skeleton.hpp"

namespace mocapress {

// Scalar first.
using Quaternion = std::array<double, 4>;

// Where a column of a clip stands: which joint it moves, and how.
struct ChannelPlace {
  std::int32_t joint = -1;
  Kind kind = Kind::tx;
};

// A skeleton whose channels are columns. A channel that no column has is 0, or the offset where it
// moves a BVH's joint.
class Rig {
 public:
  // `columns[c]` says what column c is; one of no joint, or of a channel that its joint lacks,
  // moves nothing. Angles of columns are in `radians` or degrees.
  Rig(const Skeleton& skeleton, const std::vector<ChannelPlace>& columns, bool radians);

  std::size_t joints() const { return moves_.size(); }
  // Joints, then the ends of bones in the order of their joints.
  std::size_t points() const { return moves_.size() + ends_.size(); }
  // Of each point, -1 for a root.
  std::int32_t parent(std::size_t point) const {
    return point < joints() ? moves_[point].parent : ends_[point - joints()].joint;
  }
  // Whether a frame stretches bones (ASF `l`), which has no kinematics here.
  bool stretches(const double* row) const;

  // What a column does: it moves its joint, and all below, along a direction or turns it about one.
  struct Action {
    std::size_t column, joint;
    bool turns;
  };
  // In the order of columns.
  std::vector<Action> actions() const;
  // A turn of a joint; the first is the outermost.
  struct Rotation {
    std::size_t column;
    std::size_t axis;
  };
  const std::vector<Rotation>& turns(std::size_t joint) const { return moves_[joint].turns; }
  // Lets a joint turn otherwise than its format says.
  void turn_by(std::size_t joint, std::vector<Rotation> turns) {
    moves_[joint].turns = std::move(turns);
  }
  // The directions of these in space, of a frame in which joints have these turns.
  void direct(const std::vector<Action>& actions, const double* row, const double* turns,
              Vector* directions) const;

  // Relative to the parents: (J, 3) offset and channels together, and (J, 4).
  void place_locally(const double* row, double* places, double* turns) const;
  // In space: (points, 3) and the joints' (J, 4).
  void place(const double* row, double* places, double* turns) const;

 private:
  struct Move {
    std::int32_t parent = -1;
    Vector offset{};
    std::array<std::int64_t, 3> along = {-1, -1, -1};  // columns
    std::vector<Rotation> turns;
    bool framed = false;  // turns in a frame of its own
    Quaternion frame{};
  };
  struct End {
    std::int32_t joint;
    Vector at;
  };

  Vector local_place(const Move& move, const double* row) const;
  Quaternion local_turn(const Move& move, const double* row) const;

  bool fixed_;
  bool radians_;
  std::vector<Move> moves_;
  std::vector<End> ends_;
  std::vector<std::size_t> stretching_;
};

}  // namespace mocapress
