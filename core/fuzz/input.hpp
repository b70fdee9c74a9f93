// What a fuzz target makes of its input.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "coding/bit.hpp"

namespace mocapress::fuzz {

// Takes the settings of a run from the front of the input.
class Input {
 public:
  explicit Input(ByteView bytes) : bytes_(bytes) {}

  unsigned below(unsigned bound) {
    if (bytes_.empty()) return 0;
    const unsigned byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte % bound;
  }

  // Numbers of any bits, so many at the most.
  std::vector<double> numbers(std::size_t most) {
    std::vector<double> found(std::min(most, bytes_.size() / sizeof(double)));
    const std::size_t size = found.size() * sizeof(double);
    if (size > 0) std::memcpy(found.data(), bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
    return found;
  }

  ByteView rest() const { return bytes_; }

  std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
  }

 private:
  ByteView bytes_;
};

// Whether `work` was done, or refused what it was given.
template <class Work>
bool done(Work work) {
  try {
    work();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

inline bool same_bits(std::span<const double> one, std::span<const double> other) {
  return one.size() == other.size() && std::ranges::equal(std::as_bytes(one), std::as_bytes(other));
}

}  // namespace mocapress::fuzz
