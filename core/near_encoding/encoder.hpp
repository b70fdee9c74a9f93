// Coding a chunk of `near` within bounds.
#pragma once

#include <cstddef>
#include <vector>

#include "coding/bit.hpp"
#include "near/blocks.hpp"
#include "near_encoding/leverage.hpp"

namespace mocapress::near {

// How a clip is coded.
struct Task {
  Plan plan;
  double scale = 1;                // the step of a channel that moves a point by 1
  double rate = 0.12;              // what a bit is worth, in squares of the scale
  bool tries_knots = false;        // and not only the nearest, which takes twice the time
  std::vector<double> weights;     // of the points that errors are measured at
  std::vector<double> most;        // error of each point; infinite for no bound
  std::vector<double> value_most;  // error of any value, by channel; infinite for no bound
  std::vector<bool> kept;          // of values that must come back as they are; none: all may move
  int rounds = 3;                  // of coding again what is above a bound, before it is corrected
};

struct Coded {
  Bytes payload;
  std::vector<double> values;  // what it decodes to
  std::vector<double> errors;  // of its points, frame by frame; numbers that are kept have none
};

// Codes frames x plan.steps.size() values, row by row: any values. What is no finite number comes
// back as it is, and what would be beyond a bound is kept.
// `curves` measures the channels as the curves turn them, `measure` as the values do.
Coded encode(const double* values, std::size_t frames, const Task& task, const Measure& measure,
             const Measure& curves);

// Lets a start learn from values.
void learn(Start& start, const double* values, std::size_t frames, Task task,
           const Measure& measure, const Measure& curves);

// What the curves of these values are to be, row by row.
std::vector<double> turned(std::vector<double> values, const Plan& plan);

}  // namespace mocapress::near
