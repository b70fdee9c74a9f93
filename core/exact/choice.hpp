// Of several predictions, the one that came nearest in the last frames.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace mocapress::exact {

template <std::size_t kCount>
class Choice {
 public:
  // The first of the nearest.
  std::size_t nearest() const {
    return static_cast<std::size_t>(std::ranges::min_element(errors_) - errors_.begin());
  }

  // An error beyond `farthest` counts as that.
  void learn(const double* predictions, double value, double farthest) {
    for (std::size_t i = 0; i < kCount; ++i) {
      const double error = std::min(std::fabs(value - predictions[i]), farthest);
      errors_[i] += kRate * (error - errors_[i]);
    }
  }

  template <class Visit>
  void visit(Visit&& each) {
    for (double& error : errors_) each(error);
  }

 private:
  static constexpr double kRate = 0.1;

  std::array<double, kCount> errors_{};
};

}  // namespace mocapress::exact
