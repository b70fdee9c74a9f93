// The memory of a module that JavaScript writes to.
#pragma once

#include <vector>

namespace mocapress::wasm {

// Doubles, so that numbers can stand at its front.
std::vector<double>& space();

}  // namespace mocapress::wasm
