#include "mrpa/codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "app/stored.hpp"
#include "coding/fail.hpp"
#include "coding/numbers.hpp"
#include "coding/sides.hpp"

namespace mocapress::mrpa {
namespace {

// How far the last step goes on (alpha), the last of them: no prediction at all; and how much of
// the parent is taken off before (beta). A residual r = x - beta * p goes on by alpha of its step.
constexpr std::array<double, 8> kAlphas = {0, 0.25, 0.5, 0.75, 0.875, 1, 1.25, 0};
constexpr unsigned kUnpredicted = 7;
constexpr std::array<double, 8> kBetas = {0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 1};
constexpr unsigned kWhole = 7;
constexpr unsigned kNoneYet = 8;

struct Weights {
  unsigned alpha = 0;
  unsigned beta = 0;
};

std::size_t frames_of(std::span<const Piece> pieces) {
  std::size_t frames = 0;
  for (const auto& piece : pieces) frames += piece.frames;
  return frames;
}

// One column of a piece: the frames before it stand before `values`.
struct Run {
  double* values;
  const double* parents;
  std::size_t first;  // how many known frames there are before it, two at most
  std::size_t frames;
  bool parent;
};

// The prediction of frame j, all before it being known.
template <class Float>
Float predict(const Run& run, std::size_t j, Weights weights) {
  if (weights.alpha == kUnpredicted) return Float{0};
  const double alpha = kAlphas[weights.alpha];
  const double beta = run.parent ? kBetas[weights.beta] : 0;
  const double* x = run.values + j;
  const double* p = run.parents + j;
  const std::size_t known = run.first + j;
  if (known == 0) return app::rounded<Float>(beta == 0 ? 0 : p[0]);
  double prediction = x[-1];
  if (known > 1) prediction += alpha * (x[-1] - x[-2]);
  if (beta != 0 && j > 0) {
    const double before = j > 1 ? alpha * (p[-1] - p[-2]) : 0;
    prediction += beta * ((p[0] - p[-1]) - before);
  }
  return app::rounded<Float>(prediction);
}

// Bits of a whole number, with the fraction read off the bits below the leading one.
double length_of(std::uint64_t number) {
  if (number == 0) return 0;
  const auto width = static_cast<int>(std::bit_width(number));
  return width - 1 +
         static_cast<double>(number) / static_cast<double>(std::uint64_t{1} << (width - 1));
}

// Floats in their order, so that neighbours differ by 1.
template <class Float>
std::int64_t place(Float value) {
  using Bits = typename app::Layout<Float>::Bits;
  const auto bits = std::bit_cast<Bits>(value);
  const auto magnitude = static_cast<std::int64_t>(bits & (~Bits{0} >> 1));
  return bits >> (8 * sizeof(Bits) - 1) != 0 ? -magnitude : magnitude;
}

template <class Float>
double cost(const Run& run, Weights weights) {
  double bits = 0;
  for (std::size_t j = 0; j < run.frames; ++j) {
    const auto actual = static_cast<std::uint64_t>(place(static_cast<Float>(run.values[j])));
    const auto guess = static_cast<std::uint64_t>(place(predict<Float>(run, j, weights)));
    const std::uint64_t difference = actual - guess;
    bits += length_of(std::min(difference, 0 - difference));
  }
  return bits;
}

struct Chosen {
  Weights weights;
  double bits;
};

template <class Float>
Chosen best_of(const Run& run) {
  Chosen best{{}, std::numeric_limits<double>::infinity()};
  const auto consider = [&](Weights weights) {
    const double bits = cost<Float>(run, weights);
    if (bits < best.bits) best = {weights, bits};
  };
  for (unsigned alpha = 0; alpha < kUnpredicted; ++alpha) consider({alpha, 0});
  if (!run.parent) return best;
  // The whole parent with each alpha, then the shares of it with the best of these.
  const unsigned alone = best.weights.alpha;
  for (unsigned alpha = 0; alpha < kUnpredicted; ++alpha) consider({alpha, kWhole});
  const unsigned with = best.weights.alpha;
  for (unsigned beta = 1; beta < kWhole; ++beta) {
    consider({alone, beta});
    if (with != alone) consider({with, beta});
  }
  return best;
}

template <class Float>
Weights chosen(const Run& run, Choice choice) {
  if (choice == Choice::best) return best_of<Float>(run).weights;
  if (run.parent) return {0, kWhole};
  return {choice == Choice::published ? kUnpredicted : 0, 0};
}

// Calls `visit` for each piece with its run of a column.
template <class Visit>
void for_each_piece(double* column, const double* parents, std::span<const Piece> pieces,
                    Visit visit) {
  std::size_t at = 0;
  for (const auto& piece : pieces) {
    const std::size_t before = piece.fresh ? 0 : std::min<std::size_t>(at, 2);
    visit(Run{column + at, parents + at, before, piece.frames, piece.parent});
    at += piece.frames;
  }
}

// A column of a matrix, and of another whose rows may not be there, in one piece each.
class Gathered {
 public:
  Gathered(std::size_t frames, std::size_t stride)
      : values_(frames), parents_(frames), stride_(stride) {}

  // Matrices without rows may have no address, from which nothing is counted.
  void take_values(const double* from, std::size_t column, app::Precision precision) {
    app::with_type(precision, [&](auto zero) {
      for (std::size_t j = 0; j < values_.size(); ++j) {
        values_[j] = static_cast<decltype(zero)>(from[j * stride_ + column]);
      }
    });
  }
  void take_parents(const double* from, std::size_t column) {
    for (std::size_t j = 0; j < parents_.size(); ++j) {
      const double value = from[j * stride_ + column];
      parents_[j] = std::isfinite(value) ? value : 0;
    }
  }

  double* values() { return values_.data(); }
  const double* parents() const { return parents_.data(); }

 private:
  std::vector<double> values_;
  std::vector<double> parents_;
  std::size_t stride_;
};

// What all columns of a chunk share.
struct Contexts {
  explicit Contexts(int mantissa_limit) : corrections(mantissa_limit) {}
  app::Corrections corrections;
  std::array<BitTree<3>, 9> alphas;  // by that of the piece before in the column
  std::array<BitTree<3>, 9> betas;
};

// Codes the pieces of a column; `choose` is asked on the writing side only.
template <class Float, class Side, class Choose>
void code_column(Side& side, Contexts& contexts, double* values, const double* parents,
                 std::span<const Piece> pieces, Choose choose) {
  Weights last{kNoneYet, kNoneYet};
  for_each_piece(values, parents, pieces, [&](const Run& run) {
    Weights weights;
    if constexpr (!Side::kReading) weights = choose(run);
    weights.alpha = contexts.alphas[last.alpha].code(side, weights.alpha);
    last.alpha = weights.alpha;
    if (run.parent) {
      weights.beta = contexts.betas[last.beta].code(side, weights.beta);
      last.beta = weights.beta;
    }
    auto& correction = contexts.corrections.of<Float>();
    for (std::size_t j = 0; j < run.frames; ++j) {
      run.values[j] =
          correction.code(side, static_cast<Float>(run.values[j]), predict<Float>(run, j, weights));
    }
  });
  if constexpr (Side::kReading) {
    if (!side.sound()) fail("the values are cut off");
  }
}

}  // namespace

Bytes encode(const Rows& rows, int mantissa_limit, Choice choice) {
  const std::size_t frames = frames_of(rows.pieces);
  Gathered column(frames, rows.columns.size());
  Contexts contexts(mantissa_limit);
  RangeWriting side;
  for (std::size_t c = 0; c < rows.columns.size(); ++c) {
    column.take_values(rows.values, c, rows.columns[c].precision);
    column.take_parents(rows.parents, c);
    app::with_type(rows.columns[c].precision, [&](auto zero) {
      using Float = decltype(zero);
      code_column<Float>(side, contexts, column.values(), column.parents(), rows.pieces,
                         [&](const Run& run) { return chosen<Float>(run, choice); });
    });
  }
  return side.finish();
}

void decode(ByteView payload, double* values, const double* parents, std::span<const Piece> pieces,
            std::span<const app::Column> columns, int mantissa_limit) {
  const std::size_t frames = frames_of(pieces);
  Gathered column(frames, columns.size());
  Contexts contexts(mantissa_limit);
  RangeReading side(payload);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (parents != nullptr) column.take_parents(parents, c);
    app::with_type(columns[c].precision, [&](auto zero) {
      code_column<decltype(zero)>(side, contexts, column.values(), column.parents(), pieces,
                                  [](const Run&) { return Weights{}; });
    });
    if (frames == 0) continue;
    app::restore_column(column.values(), values + c, frames, columns.size(), columns[c]);
  }
  if (!contexts.corrections.sound()) fail("a correction leaves its range");
  if (!side.exhausted()) fail("bytes are left over after the values");
}

std::vector<std::uint8_t> weights_of(const Rows& rows) {
  const std::size_t frames = frames_of(rows.pieces);
  Gathered column(frames, rows.columns.size());
  std::vector<std::uint8_t> found;
  for (std::size_t c = 0; c < rows.columns.size(); ++c) {
    column.take_values(rows.values, c, rows.columns[c].precision);
    column.take_parents(rows.parents, c);
    app::with_type(rows.columns[c].precision, [&](auto zero) {
      for_each_piece(column.values(), column.parents(), rows.pieces, [&](const Run& run) {
        const Weights best = best_of<decltype(zero)>(run).weights;
        found.push_back(static_cast<std::uint8_t>(best.alpha));
        found.push_back(static_cast<std::uint8_t>(best.beta));
      });
    });
  }
  return found;
}

std::vector<double> estimated_bits(const Rows& rows) {
  const std::size_t frames = frames_of(rows.pieces);
  Gathered column(frames, rows.columns.size());
  std::vector<double> bits(2 * rows.pieces.size());
  for (std::size_t c = 0; c < rows.columns.size(); ++c) {
    column.take_values(rows.values, c, rows.columns[c].precision);
    column.take_parents(rows.parents, c);
    app::with_type(rows.columns[c].precision, [&](auto zero) {
      using Float = decltype(zero);
      std::size_t i = 0;
      for_each_piece(column.values(), column.parents(), rows.pieces, [&](Run run) {
        const bool parent = run.parent;
        run.parent = false;
        bits[i++] += best_of<Float>(run).bits;
        run.parent = parent;
        bits[i++] += best_of<Float>(run).bits;
      });
    });
  }
  return bits;
}

}  // namespace mocapress::mrpa
