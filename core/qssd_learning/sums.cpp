#include "qssd_learning/sums.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "numbers/vector_clones.hpp"
#include "qssd_learning/first_pair.hpp"
#include "qssd_learning/parallel.hpp"
#include "qssd_learning/sparse.hpp"

#if defined(__GNUC__) && !defined(__clang__)
// As in core/motion/kinematics.cpp: no fused operations of sums and differences side by side.
#pragma GCC optimize("no-tree-slp-vectorize")
#endif

namespace mocapress::qssd {
namespace {

constexpr double kNothing = 1e-12;
constexpr double kIndependent = 1e-9;  // of an atom's length, beside those chosen before
constexpr std::size_t kLeastRows = 64;

// Rows of numbers as rows of blocks, filled up with zeros.
Blocks blocks_of_rows(const double* rows, std::size_t count, std::size_t size) {
  const std::size_t blocks = blocks_of(size);
  Blocks filled(count * blocks);
  for (std::size_t i = 0; i < count * size; ++i) {
    filled[i / size * blocks + i % size / kLanes][i % size % kLanes] = rows[i];
  }
  return filled;
}

MOCAPRESS_IN_PLACE double product(const Block* a, const Block* b, std::size_t blocks) {
  Block sum{};
  for (std::size_t i = 0; i < blocks; ++i) sum += a[i] * b[i];
  return total(sum);
}

// The triangle of a Cholesky factorization of the chosen atoms' products.
using Triangle = std::array<std::array<double, kMostAtoms>, kMostAtoms>;

MOCAPRESS_VECTOR_CLONES
void code_slice(const Block* rows, std::size_t first, std::size_t last, const Block* atoms,
                std::size_t atom_count, std::size_t blocks, const Weights& weights,
                double tolerance) {
  Blocks left(blocks);
  std::vector<Triangle> held(1);
  Triangle& triangle = held[0];
  std::array<double, kMostAtoms> projections;
  std::array<double, kMostAtoms> solved;
  for (std::size_t r = first; r < last; ++r) {
    const Block* row = rows + r * blocks;
    std::int32_t* chosen = weights.atoms + r * weights.most;
    double* weight = weights.weights + r * weights.most;
    for (std::size_t b = 0; b < blocks; ++b) left[b] = row[b];
    for (std::size_t count = 0; count < weights.most;) {
      if (product(left.data(), left.data(), blocks) <= tolerance * tolerance) break;
      std::int32_t best = -1;
      double most = kNothing;
      for (std::size_t k = 0; k < atom_count; ++k) {
        const double projection = std::fabs(product(left.data(), atoms + k * blocks, blocks));
        if (projection <= most) continue;
        if (std::find(chosen, chosen + count, static_cast<std::int32_t>(k)) != chosen + count)
          continue;
        most = projection;
        best = static_cast<std::int32_t>(k);
      }
      if (best < 0) break;
      const Block* atom = atoms + best * blocks;
      double rest = product(atom, atom, blocks);
      for (std::size_t i = 0; i < count; ++i) {
        double entry = product(atom, atoms + chosen[i] * blocks, blocks);
        for (std::size_t j = 0; j < i; ++j) entry -= triangle[count][j] * triangle[i][j];
        triangle[count][i] = entry / triangle[i][i];
        rest -= triangle[count][i] * triangle[count][i];
      }
      if (!(rest > kIndependent)) break;
      triangle[count][count] = std::sqrt(rest);
      projections[count] = product(row, atom, blocks);
      chosen[count++] = best;
      for (std::size_t i = 0; i < count; ++i) {
        solved[i] = projections[i];
        for (std::size_t j = 0; j < i; ++j) solved[i] -= triangle[i][j] * solved[j];
        solved[i] /= triangle[i][i];
      }
      for (std::size_t i = count; i-- > 0;) {
        weight[i] = solved[i];
        for (std::size_t j = i + 1; j < count; ++j) weight[i] -= triangle[j][i] * weight[j];
        weight[i] /= triangle[i][i];
      }
      for (std::size_t b = 0; b < blocks; ++b) {
        left[b] = row[b];
        for (std::size_t i = 0; i < count; ++i)
          left[b] -= weight[i] * atoms[chosen[i] * blocks + b];
      }
    }
  }
}

MOCAPRESS_VECTOR_CLONES
void learn_one(const Block* rows, std::size_t blocks, std::int32_t atom,
               const std::vector<std::size_t>& uses, Block* atoms, const Weights& weights) {
  Blocks left(uses.size() * blocks);
  for (std::size_t u = 0; u < uses.size(); ++u) {
    const std::size_t r = uses[u] / weights.most;
    for (std::size_t b = 0; b < blocks; ++b) left[u * blocks + b] = rows[r * blocks + b];
    for (std::size_t p = 0; p < weights.most; ++p) {
      const std::int32_t other = weights.atoms[r * weights.most + p];
      if (other < 0) break;
      if (other == atom) continue;
      const double weight = weights.weights[r * weights.most + p];
      for (std::size_t b = 0; b < blocks; ++b) {
        left[u * blocks + b] -= weight * atoms[other * blocks + b];
      }
    }
  }
  Blocks scratch(blocks);
  std::vector<double> along(uses.size());
  if (!first_pair(left.data(), uses.size(), blocks, atoms + atom * blocks, along.data(),
                  scratch.data()))
    return;
  for (std::size_t u = 0; u < uses.size(); ++u) weights.weights[uses[u]] = along[u];
}

}  // namespace

void code_by_sums(const double* rows, std::size_t count, std::size_t size,
                  const Dictionary& dictionary, const Weights& weights, double tolerance) {
  const Blocks filled = blocks_of_rows(rows, count, size);
  const Blocks atoms = blocks_of_rows(dictionary.logarithms, dictionary.atoms, size);
  in_parallel(count, kLeastRows, [&](std::size_t first, std::size_t last) {
    code_slice(filled.data(), first, last, atoms.data(), dictionary.atoms, blocks_of(size), weights,
               tolerance);
  });
}

void learn_sums(const double* rows, std::size_t count, std::size_t size,
                const Dictionary& dictionary, const Weights& weights) {
  const std::size_t blocks = blocks_of(size);
  const Blocks filled = blocks_of_rows(rows, count, size);
  Blocks atoms = blocks_of_rows(dictionary.logarithms, dictionary.atoms, size);
  std::vector<std::vector<std::size_t>> uses(dictionary.atoms);
  for (std::size_t i = 0; i < count * weights.most; ++i) {
    if (weights.atoms[i] >= 0) uses[weights.atoms[i]].push_back(i);
  }
  for (std::size_t k = 0; k < dictionary.atoms; ++k) {
    if (uses[k].empty()) continue;
    learn_one(filled.data(), blocks, static_cast<std::int32_t>(k), uses[k], atoms.data(), weights);
  }
  for (std::size_t i = 0; i < dictionary.atoms * size; ++i) {
    dictionary.logarithms[i] = atoms[i / size * blocks + i % size / kLanes][i % size % kLanes];
  }
}

}  // namespace mocapress::qssd
