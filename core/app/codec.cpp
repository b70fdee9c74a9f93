#include "app/codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "app/stored.hpp"
#include "coding/fail.hpp"
#include "coding/sides.hpp"

namespace mocapress::app {
namespace {

// The second term of Eq. 6, for the rows of a column after the first.
void fill_steps(std::span<double> steps, const double* parent, const std::uint8_t* choices,
                const Parameters& parameters) {
  if (parent == nullptr) {
    std::ranges::fill(steps, -0.0);  // x + -0.0 is x, for -0.0 too
    return;
  }
  for (std::size_t first = 0; first < steps.size(); first += parameters.cluster) {
    const double alpha = parameters.alphas[choices[first / parameters.cluster]];
    const std::size_t last = std::min(steps.size(), first + parameters.cluster);
    for (std::size_t j = std::max<std::size_t>(first, 1); j < last; ++j) {
      steps[j] = alpha * (parent[j] - parent[j - 1]);
    }
  }
}

// Eq. 9 for the rows [first, last) of a cluster; see docs/papers/app.md for its sign.
double ideal_alpha(const double* column, const double* parent, std::size_t first,
                   std::size_t last) {
  if (parent == nullptr) return 0;
  double product = 0;
  double square = 0;
  for (std::size_t j = std::max<std::size_t>(first, 1); j < last; ++j) {
    const double step = parent[j] - parent[j - 1];
    product += step * (column[j] - column[j - 1]);
    square += step * step;
  }
  const double alpha = product / square;
  return std::isfinite(alpha) ? alpha : 0;
}

// Index of the entry next to `alpha`, of two as near the earlier.
std::uint8_t nearest(std::span<const double> alphas, double alpha) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < alphas.size(); ++i) {
    if (std::fabs(alphas[i] - alpha) < std::fabs(alphas[best] - alpha)) best = i;
  }
  return static_cast<std::uint8_t>(best);
}

int index_bits(const Parameters& parameters) {
  return static_cast<int>(std::bit_width(parameters.alphas.size() - 1));
}

std::size_t clusters_of(std::size_t frames, std::size_t cluster) {
  return (frames + cluster - 1) / cluster;  // Eq. 2
}

// Every column after its parent, else as they are. Throws std::invalid_argument on a cycle or a
// parent that is no column.
std::vector<std::size_t> coding_order(std::span<const Column> columns) {
  std::vector<std::size_t> order;
  std::vector<bool> placed(columns.size());
  std::vector<std::size_t> line;  // a column and its ancestors that have no place yet
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::int64_t next = static_cast<std::int64_t>(c); next >= 0;) {
      if (static_cast<std::size_t>(next) >= columns.size() || line.size() > columns.size()) {
        fail("the parents of the columns are no tree");
      }
      if (placed[next]) break;
      line.push_back(static_cast<std::size_t>(next));
      next = columns[next].parent;
    }
    for (; !line.empty(); line.pop_back()) {
      placed[line.back()] = true;
      order.push_back(line.back());
    }
  }
  return order;
}

// A matrix with columns lying in one piece, and the order in which they are coded. Throws
// std::invalid_argument when the parents of the columns are no tree.
class Columns {
 public:
  Columns(std::size_t frames, std::span<const Column> columns)
      : frames_(frames), order_(coding_order(columns)), values_(frames * columns.size()) {}

  const std::vector<std::size_t>& order() const { return order_; }

  double* operator[](std::size_t column) { return values_.data() + column * frames_; }
  const double* parent_of(const Column& column) const {
    return column.parent < 0 ? nullptr : values_.data() + column.parent * frames_;
  }

 private:
  std::size_t frames_;
  std::vector<std::size_t> order_;
  std::vector<double> values_;
};

// The values as stored: of single-precision columns, what the float32 holds.
Columns stored(const double* values, std::size_t frames, std::span<const Column> columns) {
  Columns matrix(frames, columns);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    double* column = matrix[c];
    with_type(columns[c].precision, [&](auto zero) {
      for (std::size_t j = 0; j < frames; ++j) {
        column[j] = static_cast<decltype(zero)>(values[j * columns.size() + c]);
      }
    });
  }
  return matrix;
}

// Index of each column's and cluster's alpha in the table, column by column.
Bytes choose_alphas(Columns& matrix, std::size_t frames, std::span<const Column> columns,
                    const Parameters& parameters) {
  Bytes choices;
  choices.reserve(columns.size() * clusters_of(frames, parameters.cluster));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double* parent = matrix.parent_of(columns[c]);
    for (std::size_t first = 0; first < frames; first += parameters.cluster) {
      const std::size_t last = std::min(frames, first + parameters.cluster);
      choices.push_back(nearest(parameters.alphas, ideal_alpha(matrix[c], parent, first, last)));
    }
  }
  return choices;
}

// Symbols of `bits` bits (0 to 8) each, from the lowest bit of each byte up.
Bytes pack(const Bytes& symbols, int bits) {
  Bytes packed((symbols.size() * bits + 7) / 8);
  for (std::size_t i = 0; i < symbols.size() * bits; ++i) {
    packed[i / 8] |= static_cast<std::uint8_t>((symbols[i / bits] >> i % bits & 1) << i % 8);
  }
  return packed;
}

Bytes unpack(ByteView packed, std::size_t count, int bits) {
  Bytes symbols(count);
  for (std::size_t i = 0; i < count * bits; ++i) {
    symbols[i / bits] |= static_cast<std::uint8_t>((packed[i / 8] >> i % 8 & 1) << i % bits);
  }
  return symbols;
}

// Visits the columns in coding order. `visit` gets the column and a function from a row, all before
// it being known, to its prediction in the column's precision; the first row is predicted by 0.
template <class Visit>
void for_each_column(Columns& matrix, std::size_t frames, std::span<const Column> columns,
                     const Parameters& parameters, const Bytes& choices, Visit visit) {
  const std::size_t clusters = clusters_of(frames, parameters.cluster);
  std::vector<double> steps(frames);
  for (const std::size_t c : matrix.order()) {
    fill_steps(steps, matrix.parent_of(columns[c]), choices.data() + c * clusters, parameters);
    with_type(columns[c].precision, [&](auto zero) {
      visit(matrix[c], [&, column = matrix[c]](std::size_t j) {
        return j == 0 ? zero : rounded<decltype(zero)>(column[j - 1] + steps[j]);
      });
    });
  }
}

// Codes the values of `matrix`. Throws std::invalid_argument where the reading side finds what no
// writing side makes.
template <class Side>
void code_columns(Side& side, Columns& matrix, std::size_t frames, std::span<const Column> columns,
                  const Parameters& parameters, const Bytes& choices) {
  Corrections corrections(parameters.mantissa_limit);
  for_each_column(matrix, frames, columns, parameters, choices, [&](double* column, auto predict) {
    using Float = decltype(predict(0));
    auto& correction = corrections.of<Float>();
    for (std::size_t j = 0; j < frames; ++j) {
      column[j] = correction.code(side, static_cast<Float>(column[j]), predict(j));
    }
    if constexpr (Side::kReading) {
      if (!side.sound()) fail("the values are cut off");
    }
  });
  if (!corrections.sound()) fail("a correction leaves its range");
}

}  // namespace

std::vector<Precision> precisions(const double* values, std::size_t frames,
                                  std::span<const Column> columns) {
  std::vector<Precision> found;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto restored_by = [&](const NumberLine& line) {
      for (std::size_t i = c; i < frames * columns.size(); i += columns.size()) {
        const double kept = line.nearest(static_cast<float>(values[i]));
        if (std::bit_cast<std::uint64_t>(kept) != std::bit_cast<std::uint64_t>(values[i]) ||
            std::isnan(kept)) {  // which of its bits a conversion keeps depends on the machine
          return false;
        }
      }
      return true;
    };
    found.push_back(restored_by({Line::float64, 0})                     ? Precision::float32
                    : restored_by({columns[c].line, columns[c].digits}) ? Precision::snapped32
                                                                        : Precision::float64);
  }
  return found;
}

std::size_t index_size(std::size_t frames, std::size_t columns, const Parameters& parameters) {
  return (clusters_of(frames, parameters.cluster) * columns * index_bits(parameters) + 7) / 8;
}

Bytes encode(const double* values, std::size_t frames, std::span<const Column> columns,
             const Parameters& parameters) {
  Columns matrix = stored(values, frames, columns);
  const Bytes choices = choose_alphas(matrix, frames, columns, parameters);
  Bytes payload = pack(choices, index_bits(parameters));
  RangeWriting side;
  code_columns(side, matrix, frames, columns, parameters, choices);
  const Bytes coded = side.finish();
  payload.insert(payload.end(), coded.begin(), coded.end());
  return payload;
}

void decode(ByteView payload, double* values, std::size_t frames, std::span<const Column> columns,
            const Parameters& parameters) {
  const std::size_t indices = index_size(frames, columns.size(), parameters);
  if (indices > payload.size()) fail("the alpha indices are cut off");
  const Bytes choices =
      unpack(payload.first(indices), clusters_of(frames, parameters.cluster) * columns.size(),
             index_bits(parameters));
  RangeReading side(payload.subspan(indices));
  Columns matrix(frames, columns);
  code_columns(side, matrix, frames, columns, parameters, choices);
  if (!side.exhausted()) fail("bytes are left over after the values");
  if (frames == 0) return;  // what has no rows may have no address either
  for (std::size_t c = 0; c < columns.size(); ++c) {
    restore_column(matrix[c], values + c, frames, columns.size(), columns[c]);
  }
}

std::vector<double> ideal_alphas(const double* values, std::size_t frames,
                                 std::span<const Column> columns, std::size_t cluster) {
  Columns matrix = stored(values, frames, columns);
  std::vector<double> alphas;
  for (std::size_t first = 0; first < frames; first += cluster) {
    const std::size_t last = std::min(frames, first + cluster);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      alphas.push_back(ideal_alpha(matrix[c], matrix.parent_of(columns[c]), first, last));
    }
  }
  return alphas;
}

double prediction_error(const double* values, std::size_t frames, std::span<const Column> columns,
                        const Parameters& parameters) {
  Columns matrix = stored(values, frames, columns);
  const Bytes choices = choose_alphas(matrix, frames, columns, parameters);
  double error = 0;
  for_each_column(matrix, frames, columns, parameters, choices, [&](double* column, auto predict) {
    for (std::size_t j = 1; j < frames; ++j) error += std::fabs(column[j] - double{predict(j)});
  });
  return error;
}

}  // namespace mocapress::app
