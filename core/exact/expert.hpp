// Predictors of a frame, channel by channel, from the frames before it and from the channels of the
// same frame that are known already.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exact/chain.hpp"
#include "numbers/lanes.hpp"

namespace mocapress::exact {

inline constexpr double kLargest = 1e6;  // levels beyond are taken for this by the predictors

// A level within reach; of NaN the lowest.
inline double sane(double level) {
  return level > -kLargest && level < kLargest ? level : level >= kLargest ? kLargest : -kLargest;
}

// The numbers that predictors work with: the last frames, this one as far as it is known.
class Frames {
 public:
  static constexpr std::size_t kKept = 6;

  explicit Frames(std::size_t channels);

  void next();  // the frame becomes the last one
  void set(std::size_t channel, double level) {
    rows_[0][channel] = level;
    const double move = level - rows_[1][channel];
    moves_[channel] = move;
    bends_[channel] = move - (rows_[1][channel] - rows_[2][channel]);
  }
  // All frames before are taken to have been like this one.
  void fill() {
    for (std::size_t age = 1; age < kKept; ++age) rows_[age] = rows_[0];
  }
  // A second difference that this frame is guessed to have.
  void set_guess(std::size_t channel, double difference) { guesses_[channel] = difference; }
  double guess(std::size_t channel) const { return guesses_[channel]; }
  // Level of this frame (age 0) or of one before.
  double level(std::size_t channel, std::size_t age) const { return row(age)[channel]; }
  // First and second difference that end at this frame.
  double move(std::size_t channel) const { return moves_[channel]; }
  double bend(std::size_t channel) const { return bends_[channel]; }
  // Difference of order 1 or 2 that ends at the frame of that age.
  double difference(std::size_t channel, int order, std::size_t age) const {
    const double first = level(channel, age) - level(channel, age + 1);
    return order == 1 ? first : first - (level(channel, age + 1) - level(channel, age + 2));
  }
  // All channels' levels of that age.
  const Lanes& row(std::size_t age) const { return rows_[age]; }

 private:
  std::array<Lanes, kKept> rows_;  // by age
  Lanes moves_;
  Lanes bends_;
  Lanes guesses_;
};

// What an expert's chain is made of.
struct Variable {
  enum class Kind : std::uint8_t { past, known, product, guess, target } kind;
  std::uint16_t channels[3];  // one, or the two or three factors of a product
  std::uint8_t count;
  std::uint8_t age;  // in frames, of `past`
};

// Which of a channel's predictors an expert is to the last stage; the last has no place there.
inline constexpr std::size_t kLimbSlot = 0, kGuessSlot = 1, kOwnSlot = 2, kMoveSlot = 3,
                             kWholeSlot = 4, kNoSlot = 5;

struct ExpertPlan {
  std::size_t slot;
  int order;  // of the differences that are the chain's variables
  double fading;
  std::vector<Variable> variables;
};

class Expert {
 public:
  Expert(ExpertPlan plan, std::size_t channels);

  std::size_t slot() const { return plan_.slot; }
  bool predicts(std::size_t channel) const { return target_[channel] >= 0; }

  void begin();
  // The level of a channel; all channels that stand before it in the plan are known.
  double predict(std::size_t channel, const Frames& frames);
  // All channels are known: how much the frame counts, before the chain learns it.
  double weigh(const Frames& frames);
  Chain& chain() { return chain_; }

 private:
  double value(const Variable& variable, const Frames& frames) const;
  void see_until(std::size_t end, const Frames& frames);

  ExpertPlan plan_;
  Chain chain_;
  std::vector<int> target_;  // per channel: its variable, or -1
  std::vector<double> values_;
  std::size_t seen_ = 0;
  std::vector<double> usual_;  // running mean of each target's squared error
};

// The variance that every variable of a chain is taken to have at first.
inline constexpr double kChainRidge = 1e-2;

// How far off a target is against what is usual, which it learns from it; of one channel or of a
// block of them.
template <class Number>
MOCAPRESS_IN_PLACE Number unusualness(Number squared_error, Number& usual) {
  constexpr double kRate = 0.02;
  constexpr double kMost = 100;
  const Number unusual = squared_error / (usual + 1e-12);
  usual += kRate * (squared_error - usual);
  return unusual > kMost ? kMost + Number{} : unusual;
}

// A frame that is further off than usual counts for less.
inline double weight_of_frame(double unusual, double targets) {
  return 1 / std::sqrt(unusual / targets + 0.05);
}

}  // namespace mocapress::exact
