// What a codec header tells of columns beside the numbers that are coded: masks of rows that hold
// one value, and tables of float32 numbers (docs/format/exact.md, "Masks and tables").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/bit.hpp"
#include "coding/record.hpp"

namespace mocapress::exact {

// A grid, origin + step * place but for some floats, or a list of numbers (step 0).
struct Table {
  double origin = 0;
  double step = 0;
  std::vector<std::int64_t> places;  // of a grid: those of numbers that lie some floats away
  std::vector<std::int64_t> away;
  std::vector<double> numbers;  // of a list

  double number(double place) const;
};

// Rows, one behind the last of each run; the first run is of rows that the mask does not name.
using Runs = std::vector<std::size_t>;

struct Told {
  std::vector<double> values;                     // one a mask
  std::vector<std::array<std::size_t, 2>> masks;  // of each column, from 1 on; 0: none
  std::vector<Table> tables;
  std::vector<std::size_t> table;  // of each column, likewise

  // Takes the runs of all masks off a payload.
  std::vector<Runs> runs(Record& payload, std::size_t frames) const;
  // Puts numbers in the place of what was coded, frames x columns.
  void restore(double* values, std::size_t frames, std::size_t columns,
               const std::vector<Runs>& runs) const;
};

// What is left of a header.
Told read_told(Record& header, std::size_t columns);

}  // namespace mocapress::exact
