// Segmentation of a database by a self-organizing map (Section III-B of the MRPA paper).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace mocapress::mrpa {

// First and last frame.
using Segment = std::pair<std::int64_t, std::int64_t>;

// Of the `frames` of a database, cut evenly into pieces of the longest of `inputs` (Eqs. 4 and 5),
// the segments that moving towards the inputs gives (Eqs. 6 and 7), once through all inputs for
// each of the learning rates. They cover all frames and do not overlap.
std::vector<Segment> refined(std::span<const Segment> inputs, std::int64_t frames,
                             std::int64_t least_length, std::span<const double> rates);

}  // namespace mocapress::mrpa
