// What of a frame is beyond its bounds, and the corrections that bring it back.
#pragma once

#include <cstddef>
#include <vector>

#include "near/marks.hpp"
#include "near_encoding/leverage.hpp"

namespace mocapress::near {

// A point of a frame that is beyond its bound.
struct Beyond {
  std::size_t frame, point;
  double ratio;  // of its error to the bound
};

// A correction, and about how many bits it takes.
struct Mending {
  Correction correction;
  double bits;
};

class Bounds {
 public:
  // `most` of each point's error; without a rig, `value_most` of each value's, too.
  Bounds(const Measure& measure, const std::vector<double>& steps, std::vector<double> most,
         const std::vector<double>& value_most);

  // Whether any error is bounded.
  bool any() const { return any_; }
  // Puts the points of a row that are beyond their bounds, by their errors, to those found.
  void add_beyond(std::size_t frame, const double* errors, std::vector<Beyond>& found) const;
  // The channels that move any of these points, of so many joints nearest to each.
  std::vector<std::size_t> movers(const std::vector<std::size_t>& points, std::size_t joints) const;
  // The cheapest correction found of a frame in which these points are beyond their bounds; none
  // where no steps are fine enough.
  Mending mend(std::size_t frame, const std::vector<std::size_t>& points, const double* wanted,
               const double* drawn) const;

 private:
  struct Row;
  struct Few;
  void choose_few(const Row& row, const std::vector<std::size_t>& points, Mending& best) const;
  void choose(const Row& row, const std::vector<std::size_t>& candidates, Mending& best) const;
  bool is_enough(const Row& row, const Correction& one) const;
  Correction moved_back(const Row& row, const std::vector<std::size_t>& candidates,
                        int fineness) const;

  const Measure& measure_;
  const std::vector<double>& steps_;
  std::vector<double> most_;
  bool any_ = false;
  std::vector<std::vector<std::size_t>> of_joint_;  // channels
  std::vector<std::int32_t> above_;                 // of each joint: the nearest with channels
};

}  // namespace mocapress::near
