// What of a channel the channels before it foretell, learned from what was decoded.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "near/blocks.hpp"
#include "near/sums.hpp"

namespace mocapress::near {

// Of each of the columns that move, which of these before it foretell it: those of its joint, of
// the four joints above, of the joints beside it and its parent, and of the first joint.
std::vector<std::vector<std::size_t>> sources_of(const Joints& joints,
                                                 const std::vector<std::size_t>& columns);

// What is assumed of a channel and a source, by their columns, both measured in steps: how the
// source foretells, and of an observation the products of its moves and their averages.
struct Assumed {
  std::size_t channel = 0, source = 0;
  std::array<double, 2> shares{};
  double moved = 0, both = 0, averaged = 0;
};

// How channels learn to foretell each other: in how many observations sources that foretell nothing
// are assumed to have been seen, and what is left of observations after a span.
struct Pace {
  double caution, fade;
};

inline constexpr Pace kShortPace{0.125, 0.75}, kLongPace{100, 0.8};  // by the length of spans

// Predicts channel after channel of a span. What is foretold is how far a channel moves away from
// its value in the frame before the span: a sum of how far the sources do, and their averages over
// some frames.
class Prediction {
 public:
  Prediction() = default;
  // Of the channels that move: their sources, their steps, and where each begins.
  Prediction(std::vector<std::vector<std::size_t>> sources, const std::vector<double>& steps,
             const std::vector<double>& firsts, Pace pace);

  // Begins as if this had been seen in so many observations; channels are columns.
  void assume(const std::vector<Assumed>& all, double observations,
              const std::vector<std::size_t>& columns);

  void begin_span(int length);
  // Of channel i in the frames of the span, when those before it are told.
  void predict(std::size_t i, double* curve);
  // The channel's values, and what of them was not foretold.
  void tell(std::size_t i, const double* values, const double* rest);
  // Learns from the whole groups of 64 frames among the first so many.
  void end_span(std::size_t frames);

 private:
  struct Own {
    std::vector<std::size_t> sources;
    double step = 1, last = 0;
    double past[kReach + 1] = {};  // its values before the span, the latest last
    // Its values in the span; these and averages, less those of the frame before the span.
    std::vector<double> values, rest, moved, averaged;
    bool rests = true;  // whether its rest is 0 throughout the span
    // Where its part of the normal equations begins: four numbers of it and each source, of which
    // the first two are the right side; then of each source and each from it on, a square of the
    // matrix.
    std::size_t place = 0;
  };

  void find_uses();
  void find_waves(std::size_t start);
  void weigh_bands();

  std::vector<Own> channels_;
  Pace pace_{};
  std::size_t length_ = 0;
  double seen_ = 0;                // observations, which fade
  std::vector<double> equations_;  // of all channels
  std::vector<Use> uses_;          // of products, by which equations grow; none before they do
  // Of a group of frames, in rows: what all channels moved and what their averages did, side by
  // side, and the rest of those that do not rest; and the waves of these.
  std::vector<double> moves_, rests_, move_waves_, rest_waves_;
  std::vector<std::size_t> rest_of_;  // of each channel: its column in rests_
  std::vector<double> weights_;       // of each channel's bands
  std::vector<double> scratch_, shares_;
  std::vector<const double*> curves_;
};

}  // namespace mocapress::near
