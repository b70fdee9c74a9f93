// In which order frames are decoded, and from which others each is predicted: a lifting scheme
// (docs/format/qssd.md).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "qssd/body.hpp"

namespace mocapress::qssd {

inline constexpr int kMostLevels = 16;

// A frame, predicted from others by weights that add up to 1. The first of the others is the one
// before; there is none for the first frame of all.
struct Sample {
  std::size_t frame;
  std::size_t count = 0;
  std::array<std::size_t, 4> from{};
  std::array<double, 4> weights{};
};

// Frames that do not depend on each other.
struct Stage {
  std::size_t kind;  // 0: the first frame; 1: those every 2^levels frames; 2 and more: between them
  std::size_t stride;
  std::vector<Sample> samples;
};

std::vector<Stage> stages_of(std::size_t frames, int levels);

// Frames as turns, (frames, joints), and numbers, (frames, numbers).
struct Pose {
  std::vector<Quaternion> turns;
  std::vector<double> numbers;

  Pose(std::size_t frames, const Body& body)
      : turns(frames * body.joints.size()), numbers(frames * body.numbers.size()) {}
};

Quaternion predicted_turn(const Pose& pose, const Body& body, const Sample& sample,
                          std::size_t joint);
double predicted_number(const Pose& pose, const Body& body, const Sample& sample,
                        std::size_t number);

}  // namespace mocapress::qssd
