// Finding the number format of every column from how its numbers are written.
#pragma once

#include <string_view>
#include <vector>

#include "formats/body.hpp"
#include "numbers/text.hpp"

namespace mocapress {

// Some rows of a body: (R, C) values and how they are written; nothing where a row has no such
// number.
struct Sample {
  std::vector<double> values;
  std::vector<std::string_view> texts;
};

// A format per column. The format that fits most columns is preferred, so that files come out with
// few formats.
std::vector<NumberFormat> detect_formats(const std::vector<ColumnStatistics>& statistics,
                                         const Sample& sample);

}  // namespace mocapress
