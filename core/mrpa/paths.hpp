// Growing similar posture paths in a matching trellis (Wang et al., "Motion Recurring Pattern
// Analysis", IEEE Access 8, 2020, Section III-A).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mocapress::mrpa {

// The trellis: frame t of the database has the matches [starts[t], starts[t + 1]), in ascending
// order. `clips` names the clip of every frame; a path stays in one clip on either side.
struct Trellis {
  std::span<const std::int64_t> starts;
  std::span<const std::int32_t> matches;
  std::span<const float> distances;
  std::span<const std::int32_t> clips;
};

// Which of the paths that share a root is kept.
enum class Keep : std::uint8_t {
  nearest,  // the least average distance, of two the deeper: as published
  deepest,  // the deepest, of two the nearer
};

// Path i pairs frame first[i] + j of the top row with vertical[begin[i] + j] for
// begin[i] + j < begin[i + 1].
struct Paths {
  std::vector<std::int32_t> first;
  std::vector<std::int64_t> begin{0};
  std::vector<std::int32_t> vertical;
  std::vector<double> distance;  // summed over the pairs
};

// All paths of at least `least_depth` pairs, in the order of their first frames.
Paths grow(const Trellis& trellis, std::int32_t least_depth, Keep keep);

}  // namespace mocapress::mrpa
