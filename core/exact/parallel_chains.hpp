// Many small chains (exact/chain.hpp) of one size, whose frames are learned together: each vector
// register holds the same entry of eight chains.
#pragma once

#include <cstddef>
#include <vector>

#include "numbers/lanes.hpp"

namespace mocapress::exact {

class ParallelChains {
 public:
  static constexpr std::size_t kMost = 18;  // variables

  ParallelChains(std::size_t chains, std::size_t size, double fading, double ridge);

  // The values of a frame.
  void see(std::size_t chain, std::size_t variable, double value) {
    values(chain / kLanes)[variable][chain % kLanes] = value;
  }
  // Of eight chains: a block for each variable.
  Block* values(std::size_t block) { return blocks_.data() + block * stride_; }

  // Of eight chains: the entries below the diagonal in the column of a variable.
  const Block* column(std::size_t block, std::size_t variable) const {
    return blocks_.data() + block * stride_ + size_ + variable * (2 * size_ - variable - 1) / 2;
  }

  // Of the first eight chains the last variable; those of the next eight stand `stride` further on.
  Block* last_values() { return blocks_.data() + size_ - 1; }
  std::size_t stride() const { return stride_; }

  // The prediction of the last variable from those before it.
  double predicted(std::size_t chain) const;
  void predict_all(Block* predictions) const;

  // `weights`: how much the frame counts, for each chain.
  void learn(const Block* weights);

  template <class Visit>
  void visit(std::size_t chain, Visit&& each) {
    for (std::size_t i = size_; i < stride_; ++i) {
      each(reinterpret_cast<double*>(&blocks_[chain / kLanes * stride_ + i])[chain % kLanes]);
    }
  }

 private:
  std::size_t size_;
  double fading_;
  // Of eight chains: the values, the triangle below the diagonal column by column, the diagonal.
  std::size_t stride_;
  Blocks blocks_;
};

}  // namespace mocapress::exact
