// What is told of columns beside the numbers that are coded: masks of rows that hold a value of
// their own, and tables in which a column's numbers have places (docs/format/exact.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "coding/bit.hpp"
#include "coding/record.hpp"

namespace mocapress::exact {

// A grid, or a list, of float32 numbers; or all of them, each at the numbers next to it.
struct Table {
  bool all = false;
  double origin = 0, step = 0;       // of a grid; a step of 0: a list
  std::vector<std::int64_t> places;  // where a grid's numbers are some floats away; a list's floats
  std::vector<std::int64_t> away;

  // The number at a place; `fail`s where a list has none there.
  double number(double place) const;
};

class Restoring {
 public:
  using Rows = std::vector<std::pair<std::size_t, std::size_t>>;  // from, to

  // Takes what is left of a codec header. All of these `fail` where the bytes are not what an
  // encoder makes.
  void read(Record& header, std::size_t columns);

  // Takes the rows of each mask off a payload; gives what is left of it.
  ByteView take(ByteView payload, std::size_t frames, std::vector<Rows>& masks) const;

  // Puts in place what was not coded, of the first frames x columns values of a chunk.
  void restore(double* values, std::size_t frames, std::size_t columns,
               const std::vector<Rows>& masks) const;

 private:
  std::vector<double> values_;                 // of the masks
  std::vector<std::uint64_t> first_, second_;  // masks of each column, from 1 on; 0 is none
  std::vector<Table> tables_;
  std::vector<std::uint64_t> table_of_;  // likewise
};

}  // namespace mocapress::exact
