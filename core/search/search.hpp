// Search by example: signatures compared one by one, and motion aligned in time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mocapress {

// Writes the squared distance of a signature from each of `count` others, all of `size` elements.
void scan_signatures(const std::int8_t* wanted, const std::int8_t* others, std::size_t count,
                     std::size_t size, std::int32_t* distances);

// Features of motion: a row a frame, in blocks of kLanes floats, filled with 0.
class Frames {
 public:
  static constexpr std::size_t kLanes = 8;

  Frames(const float* values, std::size_t frames, std::size_t features);
  [[nodiscard]] std::size_t count() const { return count_; }
  // Distance of a frame from a frame of others, which have as many features.
  [[nodiscard]] float distance(std::size_t frame, const Frames& others, std::size_t other) const;

 private:
  std::size_t count_, blocks_;
  std::vector<float> values_;
};

// Dynamic time warping of whole motions: the least sum of distances along a path of steps (1, 0),
// (0, 1) and (1, 1), the last counting twice, divided by the frames of both. Infinite as soon as
// it is certain to be above `limit`.
float warp(const Frames& one, const Frames& other, float limit);

struct Matches {
  std::vector<float> costs;          // mean distance of a match that ends at this frame
  std::vector<std::int32_t> starts;  // its first frame
};

// Subsequence warping: for each frame of `motion` the best match of all of `wanted` that ends
// there, by steps (1, 1), (1, 2) and (2, 1), so that no match is below half or above twice as fast.
// Infinite where there is none. `damped`: distances count by their power 5/8, so that a few frames
// that are far do not rule a match out.
Matches find_stretches(const Frames& wanted, const Frames& motion, bool damped);

}  // namespace mocapress
