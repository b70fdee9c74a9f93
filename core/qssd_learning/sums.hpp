// K-SVD: rows of numbers as sums of a dictionary's atoms (the paper's Algorithm 1).
//
// M. Aharon, M. Elad, A. Bruckstein: "K-SVD: An algorithm for designing overcomplete dictionaries
// for sparse representation", IEEE Transactions on Signal Processing 54 (2006).
#pragma once

#include <cstddef>

#include "qssd_learning/products.hpp"

namespace mocapress::qssd {

// Orthogonal matching pursuit: until a row, (rows, size), has `most` atoms, (atoms, size) of length
// 1, or what is left is shorter than `tolerance`.
void code_by_sums(const double* rows, std::size_t count, std::size_t size,
                  const Dictionary& dictionary, const Weights& weights, double tolerance);

// All atoms, one after the other, and their weights. Atoms that no row uses stay.
void learn_sums(const double* rows, std::size_t count, std::size_t size,
                const Dictionary& dictionary, const Weights& weights);

}  // namespace mocapress::qssd
