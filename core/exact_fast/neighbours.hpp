// What a channel's bend (its second difference) will be, from those of the channels just before it
// in the same frame and from its own last ones: a least-squares fit for each channel, forgetting
// fast, all channels at once.
#pragma once

#include <cstddef>
#include <vector>

namespace mocapress::exact {

struct NeighbourPlan {
  std::size_t own;     // bends of the channel in the frames before
  std::size_t others;  // channels before it, at most eight
  double fading;
};

class Neighbours {
 public:
  Neighbours(std::size_t channels, const NeighbourPlan& plan);

  // `level` and the bend that is to be expected; the bends of the channels before are set.
  template <int kOthers>
  double predict(std::size_t channel, double level) const {
    double sum = level + told_[channel];
    const double* weight = weights_.data() + own_ * row_ + channel;
    const double* before = bends(0) + channel - kOthers;
    for (int i = 0; i < kOthers; ++i, weight += row_) sum += *weight * before[i];
    return sum;
  }

  void set(std::size_t channel, double bend) { bends(0)[channel] = bend; }

  // The frame is complete: learns from it, and begins the next.
  void learn();

 private:
  static constexpr std::size_t kMostOthers = 8;

  // Bends of the frame `age` ago, behind zeros that stand for channels before the first.
  double* bends(std::size_t age) {
    return bends_.data() + age * (row_ + kMostOthers) + kMostOthers;
  }
  const double* bends(std::size_t age) const {
    return bends_.data() + age * (row_ + kMostOthers) + kMostOthers;
  }

  std::size_t own_;
  std::size_t inputs_;
  double fading_;
  std::size_t row_;  // channels, padded; all below are rows of so many
  std::vector<double> bends_;
  std::vector<double> factor_;   // L of the fits' L D L^T, by columns
  std::vector<double> scale_;    // D
  std::vector<double> weights_;  // of the inputs
  std::vector<double> told_;     // the bends that the channels' own last ones tell
  std::vector<double> values_;   // while learning
  std::vector<double> alpha_;
  std::vector<double> gain_;
};

}  // namespace mocapress::exact
