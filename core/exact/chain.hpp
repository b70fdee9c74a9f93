// A chain of regressions, learned as it goes: every variable is predicted from all variables before
// it, by least squares over an exponentially fading past.
//
// The covariance of the variables, A = sum of lambda^age z z^T, is kept as its factors L D L^T: row
// r of the unit triangle L holds how the innovations of the variables before r add up to the
// prediction of r. A new z changes the factors in n^2 steps (Gill, Golub, Murray, Saunders,
// "Methods for modifying matrix factorizations", 1974, method C1, with fading), all of them element
// by element: no sum depends on the width of a vector register.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "numbers/lanes.hpp"

namespace mocapress::exact {

inline constexpr double kLeastGrown =
    1e-13;  // keeps the gain of a variable that never moves finite

class Chain {
 public:
  // `fading` is lambda; `ridge` the variance that every variable is taken to have at first.
  Chain(std::size_t count, double fading, double ridge);

  std::size_t size() const { return size_; }

  // A frame: begin, then for every variable in order: predicted (where it is asked for) and see;
  // then learn.
  void begin();
  double predicted(std::size_t variable) const { return predictions_[variable]; }
  void see(std::size_t variable, double value) { see(variable, std::span(&value, 1)); }
  // Variables that follow each other.
  void see(std::size_t first, std::span<const double> values);
  // `weight`: how much this frame counts.
  void learn(double weight);

  double innovation(std::size_t variable) const {
    return values_[variable] - predictions_[variable];
  }

  // Lets chains, the longest first, learn a frame each, several at a time, since none waits for
  // another.
  static void learn_all(std::span<Chain* const> chains, std::span<const double> weights);

  template <class Visit>
  void visit(Visit&& each) {
    for (std::size_t j = 0; j < size_; ++j) {
      for (std::size_t i = j + 1; i < size_; ++i) each(column(j)[i]);
    }
    for (std::size_t j = 0; j < size_; ++j) each(diagonal_[j]);
  }

 private:
  // The column of a variable, from the block that the variable stands in; zeros up to it.
  Block* column_blocks(std::size_t variable) { return triangle_.data() + offsets_[variable]; }
  double* column(std::size_t variable) {
    return reinterpret_cast<double*>(column_blocks(variable)) - kLanes * (variable / kLanes);
  }

  std::size_t size_;
  double fading_;
  Lanes diagonal_;
  std::vector<std::size_t> offsets_;
  Blocks triangle_;  // L below its diagonal, column by column
  Lanes predictions_;
  Lanes values_;
  Lanes rest_;
};

}  // namespace mocapress::exact
