// Python's view of search/search.hpp.
#include "search/search.hpp"

#include <nanobind/stl/pair.h>

#include <utility>

#include "python/bindings.hpp"

namespace mocapress {
namespace {

using Features = Input<float, 2>;

Given<std::int32_t> bound_scan(const Input<std::int8_t, 1>& wanted,
                               const Input<std::int8_t, 2>& others) {
  if (wanted.shape(0) != others.shape(1)) throw nb::value_error("signatures of other sizes");
  std::vector<std::int32_t> distances(others.shape(0));
  {
    const nb::gil_scoped_release release;
    scan_signatures(wanted.data(), others.data(), others.shape(0), others.shape(1),
                    distances.data());
  }
  return give(std::move(distances));
}

Frames frames_of(const Features& features) {
  return {features.data(), features.shape(0), features.shape(1)};
}

void check_alike(const Features& one, const Features& other) {
  if (one.shape(1) != other.shape(1)) throw nb::value_error("motions of other features");
}

float bound_warp(const Features& one, const Features& other, float limit) {
  check_alike(one, other);
  const nb::gil_scoped_release release;
  return warp(frames_of(one), frames_of(other), limit);
}

std::pair<Given<float>, Given<std::int32_t>> bound_find_stretches(const Features& wanted,
                                                                  const Features& motion,
                                                                  bool damped) {
  check_alike(wanted, motion);
  Matches matches;
  {
    const nb::gil_scoped_release release;
    matches = find_stretches(frames_of(wanted), frames_of(motion), damped);
  }
  return {give(std::move(matches.costs)), give(std::move(matches.starts))};
}

}  // namespace

void bind_search(nb::module_& module) {
  module.def("scan_signatures", &bound_scan, nb::arg("wanted"), nb::arg("others"),
             "Squared distances of an int8 signature (D,) from others (N, D): (N,) int32.");
  module.def("warp", &bound_warp, nb::arg("one"), nb::arg("other"), nb::arg("limit"),
             "Mean distance along the best alignment of (F, D) and (G, D), or infinity where it is "
             "above the limit.");
  module.def(
      "find_stretches", &bound_find_stretches, nb::arg("wanted"), nb::arg("motion"),
      nb::arg("damped") = false,
      "Of each frame of the motion (G, D), the best match of (F, D) that ends there: mean "
      "distances (G,), infinite for none, and first frames (G,). Damped: of distances to 5/8.");
}

}  // namespace mocapress
