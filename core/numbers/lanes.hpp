// Numbers in blocks of eight: vectors of the compiler, which it splits where registers are
// narrower. All they do is element by element, so every width gives the same bits. How a block is
// passed depends on the instruction set, so what takes or gives one by value is always compiled in
// place.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace mocapress {

inline constexpr std::size_t kLanes = 8;

using Block = double __attribute__((vector_size(kLanes * sizeof(double))));

// Blocks lie where a register of their size may load them in one go; that of the standard library
// does not see what a vector's attributes ask for.
template <class Value>
struct BlockAllocator {
  using value_type = Value;
  static constexpr std::align_val_t kAlignment{sizeof(Block)};

  Value* allocate(std::size_t count) {
    return static_cast<Value*>(::operator new(count * sizeof(Value), kAlignment));
  }
  void deallocate(Value* values, std::size_t) { ::operator delete(values, kAlignment); }
  bool operator==(const BlockAllocator&) const { return true; }
};

using Blocks = std::vector<Block, BlockAllocator<Block>>;

#define MOCAPRESS_IN_PLACE [[gnu::always_inline]] inline

inline std::size_t blocks_of(std::size_t count) { return (count + kLanes - 1) / kLanes; }

// A number for each of so many things; the last block is filled up.
class Lanes {
 public:
  Lanes() = default;
  Lanes(std::size_t count, double value) : blocks_(blocks_of(count), Block{} + value) {}

  double operator[](std::size_t i) const { return data()[i]; }
  double& operator[](std::size_t i) { return data()[i]; }
  double* data() { return reinterpret_cast<double*>(blocks_.data()); }
  const double* data() const { return reinterpret_cast<const double*>(blocks_.data()); }
  Block& block(std::size_t b) { return blocks_[b]; }
  const Block& block(std::size_t b) const { return blocks_[b]; }
  Block* blocks() { return blocks_.data(); }
  const Block* blocks() const { return blocks_.data(); }
  std::size_t count_blocks() const { return blocks_.size(); }

 private:
  Blocks blocks_;
};

}  // namespace mocapress
