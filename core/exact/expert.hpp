// Predictors of a frame, channel by channel, from the frames before it and from the channels of the
// same frame that are known already.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exact/chain.hpp"

namespace mocapress::exact {

// The numbers that predictors work with: the last frames, this one as far as it is known.
class Frames {
 public:
  static constexpr int kKept = 6;

  explicit Frames(std::size_t channels);

  void next();  // the frame becomes the last one
  void set(std::size_t channel, double level);
  // A second difference that this frame is guessed to have.
  void set_guess(std::size_t channel, double difference) { guesses_[channel] = difference; }
  double guess(std::size_t channel) const { return guesses_[channel]; }
  // Level of this frame (age 0) or of one before.
  double level(std::size_t channel, int age) const { return at(age)[channel]; }
  // Difference of order 1 or 2 that ends at the frame of that age.
  double difference(std::size_t channel, int order, int age) const {
    const double first = level(channel, age) - level(channel, age + 1);
    return order == 1 ? first : first - (level(channel, age + 1) - level(channel, age + 2));
  }

 private:
  const double* at(int age) const { return levels_.data() + rows_[static_cast<std::size_t>(age)]; }

  std::vector<double> levels_;
  std::array<std::size_t, kKept> rows_;  // where the frame of each age begins
  std::vector<double> guesses_;
};

// What an expert's chain is made of.
struct Variable {
  enum class Kind : std::uint8_t { past, known, product, guess, target } kind;
  std::uint16_t channels[3];  // one, or the two or three factors of a product
  std::uint8_t count;
  std::uint8_t age;  // in frames, of `past`
};

struct ExpertPlan {
  int order;  // of the differences that are the chain's variables
  double fading;
  std::vector<Variable> variables;
};

class Expert {
 public:
  Expert(ExpertPlan plan, std::size_t channels);

  bool predicts(std::size_t channel) const { return target_[channel] >= 0; }

  void begin();
  // The level of a channel; all channels that stand before it in the plan are known.
  double predict(std::size_t channel, const Frames& frames);
  // All channels are known.
  void learn(const Frames& frames);

 private:
  double value(const Variable& variable, const Frames& frames) const;
  void see_until(std::size_t end, const Frames& frames);

  ExpertPlan plan_;
  Chain chain_;
  std::vector<int> target_;  // per channel: its variable, or -1
  std::size_t seen_ = 0;
  std::vector<double> usual_;  // running mean of each target's squared error
};

}  // namespace mocapress::exact
