// The preset dictionary of the container, src/mocapress/container/dictionary1.bin, which the build
// makes a source file of.
#pragma once

#include "coding/bit.hpp"

namespace mocapress::player {

ByteView dictionary();

}  // namespace mocapress::player
