// How a number is coded beside its prediction.
//
// Where the scale spans several numbers of the line, the line is cut into 64 buckets whose bounds
// are fixed multiples of the scale away from the prediction; the bucket is coded bit by bit with
// chances that adapt, so that the true shape of the distribution is learned, and within the bucket
// all numbers are equally likely. Where the scale is smaller than that, the number of steps from
// the nearest number is coded.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coding/numbers.hpp"
#include "numbers/line.hpp"

namespace mocapress::exact {

inline constexpr int kBucketBits = 6;
inline constexpr int kBuckets = 1 << kBucketBits;

// A chance that adapts slowly, in 1/2^32.
template <int kRate>
struct Chance {
  std::uint32_t of_one = 1u << 31;

  void learn(bool one) {
    if (one) {
      of_one += (~of_one) >> kRate;
    } else {
      of_one -= of_one >> kRate;
    }
  }
};

// The shape of the distribution, for all channels and for each of them.
struct Shape {
  template <int kRate>
  using Nodes = std::array<Chance<kRate>, kBuckets>;

  explicit Shape(std::size_t channels);

  Nodes<7> fast;
  Nodes<10> slow;
  std::vector<Nodes<6>> own;
};

// The models of what the buckets leave open.
struct Remainders {
  static constexpr int kOctaves = 8;
  static constexpr int kUnary = 24;
  static constexpr int kDecades = 1 << 10;
  struct Steps {
    std::array<Bit, 4> none;
    std::array<Bit, 4> negative;
    std::array<Bit, kUnary> more;
  };

  std::array<BitTree<6>, 2> beyond;   // distance from the first and the last bucket: its bits
  std::array<Steps, kOctaves> steps;  // by the scale, in steps of the line
  BitTree<6> far;                     // more than kUnary steps: the bits
  Bit negative;                       // sign of a number in a bucket around zero
  std::array<Bit, kDecades> smaller;  // whether it lies in a lower decade still
  Bit first_negative;
  Bit first_below;
  BitTree<6> first;  // of a channel's first number: the bits
};

class Residual {
 public:
  explicit Residual(std::size_t channels) : shape_(channels) {}

  // Codes a number beside its prediction; `scale` > 0 is the scale of the distribution. Any number
  // comes back, one that is not on the line, too. Where the reading side finds nonsense, some
  // number.
  template <class Side>
  double code(Side& side, std::size_t channel, const NumberLine& line, double prediction,
              double scale, double number);

  // A number of which nothing is known.
  template <class Side>
  double code_first(Side& side, const NumberLine& line, double number);

  template <class Visit>
  void visit(Visit&& each) {
    for (auto& node : shape_.fast) each(node.of_one);
    for (auto& node : shape_.slow) each(node.of_one);
  }
  // Every channel begins with the shape of all.
  void share_shape();

 private:
  Shape shape_;
  Remainders remainders_;
};

}  // namespace mocapress::exact
