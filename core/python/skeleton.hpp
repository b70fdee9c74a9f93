// Skeletons between mocapress.motion.skeleton and motion/skeleton.hpp.
#pragma once

#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "motion/skeleton.hpp"
#include "python/bindings.hpp"

namespace mocapress {

// A text of the core, UTF-8 in which surrogates may stand alone, for Python, and back.
nb::str text(std::string_view utf8);
std::string utf8_of(nb::handle text);

using VectorTuple = std::tuple<double, double, double>;
template <class Element>
using TupleOf = nb::typed<nb::tuple, Element, nb::ellipsis>;
using JointTuple = std::tuple<nb::str, std::int32_t, VectorTuple, TupleOf<nb::str>, VectorTuple,
                              nb::str, TupleOf<std::tuple<double, double>>, TupleOf<VectorTuple>>;

// The fields of each mocapress.motion.Joint, in their order.
std::vector<JointTuple> joints_of(const Skeleton& skeleton);
// ValueError where it has what no skeleton of the core has: an unknown channel, or a joint that
// stands before its parent.
Skeleton skeleton_from(nb::handle skeleton);

}  // namespace mocapress
