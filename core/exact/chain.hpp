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
#include <vector>

namespace mocapress::exact {

class Chain {
 public:
  // `fading` is lambda; `ridge` the variance that every variable is taken to have at first.
  Chain(std::size_t count, double fading, double ridge);

  std::size_t size() const { return diagonal_.size(); }

  // A frame: begin, then for every variable in order: predicted (where it is asked for) and see;
  // then learn.
  void begin();
  double predicted(std::size_t variable) const { return predictions_[variable]; }
  void see(std::size_t variable, double value);
  // `weight`: how much this frame counts.
  void learn(double weight);

  double innovation(std::size_t variable) const {
    return values_[variable] - predictions_[variable];
  }

  template <class Visit>
  void visit(Visit&& each) {
    for (auto& factor : triangle_) each(factor);
    for (auto& variance : diagonal_) each(variance);
  }

 private:
  double* column(std::size_t variable) { return triangle_.data() + offsets_[variable]; }

  double fading_;
  std::vector<double> diagonal_;
  std::vector<std::size_t> offsets_;
  std::vector<double> triangle_;  // L below its diagonal, column by column
  std::vector<double> predictions_;
  std::vector<double> values_;
  std::vector<double> rest_;
};

}  // namespace mocapress::exact
