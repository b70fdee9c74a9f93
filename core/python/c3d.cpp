// Python's view of formats/c3d.hpp.
#include "formats/c3d.hpp"

#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "python/bindings.hpp"

namespace mocapress {
namespace {

using Frames = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;
// Group, whether it is one, name, type, dimensions, begin, size.
using Parameter = std::tuple<int, bool, nb::bytes, int, nb::bytes, std::uint64_t, std::uint64_t>;
using Found = std::tuple<int, bool, std::uint64_t, std::uint64_t, std::uint64_t, std::uint64_t,
                         Frames, bool, Frames, std::vector<Parameter>>;

Found layout(const nb::bytes& data, std::uint64_t size) {
  const C3dLayout found = c3d_layout(view(data), size);
  const auto frames = [](const C3dFrames& own) {
    return Frames(own.begin, own.count, own.numbers);
  };
  std::vector<Parameter> parameters;
  for (const C3dParameter& own : found.parameters) {
    parameters.emplace_back(own.group, own.is_group, nb::bytes(own.name.data(), own.name.size()),
                            own.type, nb::bytes(own.dimensions.data(), own.dimensions.size()),
                            own.begin, own.size);
  }
  return {static_cast<int>(found.processor),
          found.floats,
          found.announced,
          found.points,
          found.analog,
          found.samples,
          frames(found.frames),
          found.stated,
          frames(found.rotations),
          std::move(parameters)};
}

}  // namespace

void bind_c3d(nb::module_& module) {
  module.def(
      "c3d_layout", &layout, nb::arg("data"), nb::arg("size"),
      "Of a file of so many bytes, which begins with these, give processor, whether numbers\n"
      "are floats, announced frames, points, analog numbers in a frame, samples of each channel\n"
      "in it; begin, count and numbers of the frames, whether the file states that count; the "
      "same\n"
      "of the rotations; and the parameters: see core/formats/c3d.hpp.");
}

}  // namespace mocapress
