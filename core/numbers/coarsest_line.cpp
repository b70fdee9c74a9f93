#include "numbers/coarsest_line.hpp"

#include <cmath>
#include <optional>

namespace mocapress {
namespace {

constexpr std::size_t kStrays = 64;     // one number of so many may be off the line
constexpr std::size_t kNotNumbers = 8;  // and one of so many no number, as it is off all lines
constexpr std::size_t kSample = 256;    // rows
constexpr double kTie = 1e-3;
constexpr double kTelling = 30;  // chance would need e^30 tries to look like this
constexpr int kMostDecimals = 15;
constexpr int kMostSignificant = 15;

struct ColumnView {
  const double* values;
  std::size_t rows;
  std::size_t stride;

  double operator[](std::size_t row) const { return values[row * stride]; }
};

bool holds(const NumberLine& line, const ColumnView& column) {
  const std::size_t most = column.rows / kStrays;
  const std::size_t most_not_numbers = column.rows / kNotNumbers;
  std::size_t strays = 0;
  std::size_t not_numbers = 0;
  for (std::size_t row = 0; row < column.rows; ++row) {
    const double value = column[row];
    if (std::isnan(value)) {
      if (++not_numbers > most_not_numbers) return false;
    } else if (!line.holds(value, line.place(value)) && ++strays > most) {
      return false;
    }
  }
  return true;
}

std::optional<int> fewest(Line line, int from, int to, const ColumnView& column) {
  for (int digits = from; digits <= to; ++digits) {
    if (holds(NumberLine(line, digits), column)) return digits;
  }
  return std::nullopt;
}

// Distances of neighbours in some of the rows, on a logarithmic scale.
double coarseness(const NumberLine& line, const ColumnView& column) {
  double sum = 0;
  for (std::size_t row = 0; row < column.rows; row += column.rows / kSample + 1) {
    const double step = line.step(column[row]);
    sum += step > 0 ? std::log(step) : 0;
  }
  return sum;
}

// How decimals came about, where many of them say so.
LineOf printed_line(int decimals, const ColumnView& column) {
  const double plain = coarseness({Line::decimals, decimals}, column);
  for (const Line line : {Line::printed32, Line::degrees32}) {
    const NumberLine printed(line, decimals);
    if (coarseness(printed, column) > plain + kTelling && holds(printed, column)) {
      return {line, decimals};
    }
  }
  return {Line::decimals, decimals};
}

LineOf coarsest_line(const ColumnView& column) {
  const auto decimals = fewest(Line::decimals, 0, kMostDecimals, column);
  const auto significant = fewest(Line::significant, 1, kMostSignificant, column);
  if (decimals) {
    const LineOf fixed = printed_line(*decimals, column);
    if (!significant) return fixed;
    const double gain = coarseness({fixed.line, fixed.digits}, column) -
                        coarseness({Line::significant, *significant}, column);
    return gain > kTie ? fixed : LineOf{Line::significant, *significant};
  }
  if (holds({Line::float32, 0}, column)) return {Line::float32, 0};
  // Nine digits and more may be how float32 was printed.
  if ((!significant || *significant >= 7) && holds({Line::shortest32, 0}, column)) {
    return {Line::shortest32, 0};
  }
  if (significant) return {Line::significant, *significant};
  return {Line::float64, 0};
}

}  // namespace

std::vector<LineOf> coarsest_lines(const double* values, std::size_t rows, std::size_t columns) {
  std::vector<LineOf> lines;
  lines.reserve(columns);
  for (std::size_t c = 0; c < columns; ++c)
    lines.push_back(coarsest_line({values + c, rows, columns}));
  return lines;
}

}  // namespace mocapress
