// Curves of a few frames as sums of cosines.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "numbers/arithmetic.hpp"

namespace mocapress::patterns {

// The cosines of n frames, an orthonormal basis: row k, frame t.
class Cosines {
 public:
  explicit Cosines(std::size_t frames) : frames_(frames), weights_(frames * frames) {
    const auto size = static_cast<double>(frames);
    for (std::size_t k = 0; k < frames; ++k) {
      const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / size);
      for (std::size_t t = 0; t < frames; ++t) {
        const auto i = static_cast<double>((2 * t + 1) * k % (4 * frames));
        const double angle = (3.141592653589793 * i) / (2 * size);
        weights_[k * frames + t] = scale * sine_cosine(angle).cosine;
      }
    }
  }

  std::size_t frames() const { return frames_; }
  const double* of(std::size_t k) const { return weights_.data() + k * frames_; }

 private:
  std::size_t frames_;
  std::vector<double> weights_;
};

}  // namespace mocapress::patterns
