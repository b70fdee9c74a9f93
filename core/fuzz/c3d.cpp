// The layout of a C3D file, found in any bytes: nothing that it names lies outside them.
#include "formats/c3d.hpp"

#include <cstdint>
#include <cstdlib>

using namespace mocapress;

namespace {

bool inside(const C3dFrames& frames, std::size_t size_of_number, std::size_t size) {
  if (frames.count == 0) return true;
  return frames.begin <= size && frames.numbers > 0 &&
         frames.count <= (size - frames.begin) / (frames.numbers * size_of_number);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const C3dLayout layout = c3d_layout({data, size}, size);
  const std::size_t number = layout.floats ? 4 : 2;
  if (!inside(layout.frames, number, size) || !inside(layout.rotations, number, size)) std::abort();
  if (layout.frames.count > 0 && layout.frames.numbers != 4 * layout.points + layout.analog)
    std::abort();
  if (layout.samples == 0 || layout.analog % layout.samples != 0) std::abort();
  for (const C3dParameter& parameter : layout.parameters) {
    if (parameter.begin > size || parameter.size > size - parameter.begin) std::abort();
  }
  return 0;
}
