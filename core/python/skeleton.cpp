#include "python/skeleton.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

namespace mocapress {
namespace {

VectorTuple tuple_of(const Vector& v) { return {v[0], v[1], v[2]}; }

Kind kind_of(const std::string& word) {
  const auto* const found = std::find(kKindNames.begin(), kKindNames.end(), word);
  if (found == kKindNames.end()) throw nb::value_error("no such channel");
  return static_cast<Kind>(found - kKindNames.begin());
}

Vector vector_from(nb::handle vector) {
  return {nb::cast<double>(vector[0]), nb::cast<double>(vector[1]), nb::cast<double>(vector[2])};
}

}  // namespace

nb::str text(std::string_view utf8) {
  PyObject* const made =
      PyUnicode_DecodeUTF8(utf8.data(), static_cast<Py_ssize_t>(utf8.size()), "surrogatepass");
  if (made == nullptr) throw nb::python_error();
  return nb::steal<nb::str>(made);
}

std::string utf8_of(nb::handle text) {
  const auto bytes =
      nb::steal<nb::bytes>(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogatepass"));
  if (!bytes.is_valid()) throw nb::python_error();
  return std::string(text_of(bytes));
}

std::vector<JointTuple> joints_of(const Skeleton& skeleton) {
  std::vector<JointTuple> joints;
  for (const Joint& joint : skeleton.joints) {
    nb::list channels;
    for (const Kind kind : joint.channels) channels.append(text(name_of(kind)));
    nb::list limits;
    for (const auto& [low, high] : joint.limits) limits.append(nb::make_tuple(low, high));
    nb::list ends;
    for (const Vector& end : joint.ends) ends.append(tuple_of(end));
    joints.emplace_back(text(joint.name), joint.parent, tuple_of(joint.offset), nb::tuple(channels),
                        tuple_of(joint.axis), text(joint.axis_order), nb::tuple(limits),
                        nb::tuple(ends));
  }
  return joints;
}

Skeleton skeleton_from(nb::handle skeleton) {
  Skeleton made;
  made.fixed = nb::cast<std::string>(skeleton.attr("rotation")) == "fixed";
  made.radians = nb::cast<std::string>(skeleton.attr("angle_unit")) == "rad";
  for (const nb::handle from : skeleton.attr("joints")) {
    Joint joint;
    joint.name = utf8_of(from.attr("name"));
    joint.parent = nb::cast<std::int32_t>(from.attr("parent"));
    joint.offset = vector_from(from.attr("offset"));
    for (const nb::handle kind : from.attr("channels"))
      joint.channels.push_back(kind_of(nb::cast<std::string>(kind)));
    joint.axis = vector_from(from.attr("axis"));
    joint.axis_order = nb::cast<std::string>(from.attr("axis_order"));
    for (const nb::handle end : from.attr("ends")) joint.ends.push_back(vector_from(end));
    const auto index = static_cast<std::int32_t>(made.joints.size());
    std::string sorted = joint.axis_order;
    std::sort(sorted.begin(), sorted.end());
    if (joint.parent < -1 || joint.parent >= index || sorted != "xyz")
      throw nb::value_error("no skeleton: a parent behind its joint, or no order of axes");
    made.joints.push_back(std::move(joint));
  }
  return made;
}

}  // namespace mocapress
