// Reading the records of which files and codec headers are made: docs/format.md, "Conventions".
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coding/bit.hpp"

namespace mocapress {

// Takes fields off, in order. Never goes past its bytes, never believes a length; what is wrong
// makes it `fail`.
class Record {
 public:
  explicit Record(ByteView bytes) : left_(bytes) {}

  static constexpr std::uint64_t kMost = (std::uint64_t{1} << 63) - 1;

  std::size_t left() const { return left_.size(); }
  ByteView raw(std::size_t count);
  ByteView bytes() { return raw(integer(left_.size())); }
  std::uint64_t integer(std::uint64_t most = kMost);
  std::int64_t signed_integer();
  double number();
  std::vector<double> numbers(std::size_t count);
  // Lists of so many numbers, in which equal neighbours stand together.
  std::vector<std::uint64_t> runs(std::size_t count, std::uint64_t most);
  // And in which few differ: how many, these, and which of them each is.
  std::vector<std::uint64_t> palette(std::size_t count, std::uint64_t most);
  std::vector<std::size_t> indices(std::size_t count, std::size_t size);
  // See that nothing is left.
  void end() const;

 private:
  ByteView left_;
};

}  // namespace mocapress
