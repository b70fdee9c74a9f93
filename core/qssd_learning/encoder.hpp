// The encoder of the codec `qssd`.
#pragma once

#include <cstddef>
#include <vector>

#include "qssd/codec.hpp"

namespace mocapress::qssd {

struct Effort {
  std::size_t most;      // atoms of a frame
  double rounding;       // of weights: what is added before the fraction is cut off
  double rest_rounding;  // of what atoms leave
};

// The numbers that frames are coded as, (samples, atoms + columns), in the order of the stages.
std::vector<std::int64_t> symbols_of(const double* values, std::size_t frames, const Plan& plan,
                                     const Effort& effort);

// A chunk. `max_errors`, (frames, columns), limits the error of each value; infinite ones leave it.
// NaN, infinities and whatever else the plan cannot say stand in the chunk as they are.
Bytes encode_chunk(const double* values, std::size_t frames, const Plan& plan, const Effort& effort,
                   const double* max_errors);

// The turns and numbers of rows; of what cannot be coded, those of the row before, or behind.
Pose pose_of(const double* values, std::size_t frames, const Plan& plan);

// What frames turn by from their predictions, where nothing was lost: (samples, joints), to learn
// from.
std::vector<Quaternion> displacements(const double* values, std::size_t frames, const Plan& plan);

// The kinds of the stages of the coded samples.
std::vector<std::size_t> kinds_of(std::size_t frames, const Plan& plan);

}  // namespace mocapress::qssd
