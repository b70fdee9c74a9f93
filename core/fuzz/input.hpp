// What a fuzz target makes of its input.
#pragma once

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

  ByteView rest() const { return bytes_; }

 private:
  ByteView bytes_;
};

}  // namespace mocapress::fuzz
