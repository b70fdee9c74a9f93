// Python's view of motion/kinematics.hpp.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "motion/kinematics.hpp"
#include "python/bindings.hpp"
#include "python/skeleton.hpp"

namespace mocapress {
namespace {

using Placed = std::tuple<Given<double, 3>, Given<double, 3>>;

std::optional<Placed> bound_place(const Input<double, 2>& values, const nb::object& skeleton,
                                  const std::vector<std::pair<std::int32_t, std::string>>& columns,
                                  bool radians, bool locally) {
  if (columns.size() != values.shape(1)) throw nb::value_error("values of other columns");
  std::vector<ChannelPlace> channels;
  for (const auto& [joint, word] : columns) {
    const auto* const kind = std::find(kKindNames.begin(), kKindNames.end(), word);
    const bool known = kind != kKindNames.end();
    channels.push_back(
        {known ? joint : -1, static_cast<Kind>(known ? kind - kKindNames.begin() : 0)});
  }
  const Rig rig(skeleton_from(skeleton), channels, radians);
  const std::size_t frames = values.shape(0);
  const std::size_t points = locally ? rig.joints() : rig.points();
  std::vector<double> places(frames * points * 3);
  std::vector<double> turns(frames * rig.joints() * 4);
  bool stretched = false;
  {
    const nb::gil_scoped_release release;
    for (std::size_t f = 0; f < frames && !stretched; ++f) {
      const double* const row = values.data() + f * values.shape(1);
      double* const place = places.data() + f * points * 3;
      double* const turn = turns.data() + f * rig.joints() * 4;
      stretched = rig.stretches(row);
      if (locally) {
        rig.place_locally(row, place, turn);
      } else {
        rig.place(row, place, turn);
      }
    }
  }
  if (stretched) return {};
  return Placed{give(std::move(places), std::array{frames, points, std::size_t{3}}),
                give(std::move(turns), std::array{frames, rig.joints(), std::size_t{4}})};
}

}  // namespace

void bind_motion(nb::module_& module) {
  module.def("place", &bound_place, nb::arg("values"), nb::arg("skeleton"), nb::arg("columns"),
             nb::arg("radians"), nb::arg("locally"),
             "Give the places of joints and then end sites, (F, P, 3), and the joints' turns,\n"
             "(F, J, 4), in space, or ``locally``, of joints alone, relative to their parents.\n\n"
             "Columns are told as joint and kind. None where bones stretch.");
}

}  // namespace mocapress
