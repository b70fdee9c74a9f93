// The columns of codecs that code floats by APP's floating-point compression.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <vector>

#include "app/codec.hpp"
#include "python/bindings.hpp"

namespace mocapress {

// Parent, precision, line, digits.
using FloatPlan = Plan<std::int32_t, 4>;

inline std::vector<app::Column> float_columns(const FloatPlan& plan, std::size_t count) {
  if (plan.shape(0) != count) throw std::invalid_argument("the plan is not for these columns");
  std::vector<app::Column> columns(count);
  for (std::size_t c = 0; c < count; ++c) {
    const std::int32_t* row = plan.data() + 4 * c;
    const Line line = line_exists(row[2], row[3]) ? static_cast<Line>(row[2]) : Line::float64;
    columns[c] = {row[0], static_cast<app::Precision>(row[1]), line, row[3]};
  }
  return columns;
}

}  // namespace mocapress
