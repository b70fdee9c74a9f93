// Which numbers a column holds: the coarsest line that has (nearly) all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "numbers/line.hpp"

namespace mocapress {

struct LineOf {
  Line line;
  int digits;
};

// For each column of a matrix, row by row in `values`. A line is taken where at most one number in
// 64 is not on it.
std::vector<LineOf> coarsest_lines(const double* values, std::size_t rows, std::size_t columns);

}  // namespace mocapress
