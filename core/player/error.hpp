// What libmocapress cannot do, though a file may be in order. What is wrong in a file makes the
// kernels `fail`.
#pragma once

#include <stdexcept>

namespace mocapress::player {

struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace mocapress::player
