// Python's view of formats/motion_file.hpp.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <utility>

#include "formats/motion_file.hpp"
#include "formats/rows.hpp"
#include "formats/text.hpp"
#include "python/bindings.hpp"
#include "python/skeleton.hpp"

namespace mocapress {
namespace {

// Moves what Python keeps out of what was read; it is asked for once.
template <class Element>
Given<Element> taken(std::vector<Element>& from) {
  return give(std::move(from));
}

Given<double, 2> values_of(Body& body) {
  return give(std::move(body.values), std::array{body.rows(), body.columns});
}

Given<std::uint8_t, 2> statistics_of(const Body& body) {
  std::vector<std::uint8_t> statistics;
  for (const auto& column : body.statistics)
    statistics.insert(statistics.end(),
                      {column.least_decimals, column.most_decimals, column.most_significant,
                       column.exponent_digits, column.trailing_zero, column.whole_without_point,
                       column.bare_point, column.upper});
  return give(std::move(statistics), std::array{body.columns, std::size_t{8}});
}

using SlotTuple = std::tuple<std::int32_t, std::uint32_t, std::uint32_t>;

std::vector<SlotTuple> tuples(const std::vector<Slot>& slots) {
  std::vector<SlotTuple> list;
  for (const Slot& slot : slots) list.emplace_back(slot.column, slot.begin, slot.end);
  return list;
}

std::optional<nb::bytes> bound_from_utf16(const nb::bytes& data) {
  const auto text = from_utf16(text_of(data));
  if (!text) return {};
  return nb::bytes(text->data(), text->size());
}

MotionFile bound_read_bvh(const nb::bytes& data) {
  const nb::gil_scoped_release release;
  return read_bvh(text_of(data));
}

MotionFile bound_read_amc(const nb::bytes& data, const nb::object& skeleton) {
  if (skeleton.is_none()) {
    const nb::gil_scoped_release release;
    return read_amc(text_of(data), nullptr);
  }
  const Skeleton read = skeleton_from(skeleton);
  const nb::gil_scoped_release release;
  return read_amc(text_of(data), &read);
}

SkeletonFile bound_read_asf(const nb::bytes& data) {
  const nb::gil_scoped_release release;
  return read_asf(text_of(data));
}

Body bound_read_rows(const nb::bytes& data, std::uint64_t begin, std::size_t columns) {
  if (begin > data.size()) throw nb::value_error("an offset outside the data");
  const nb::gil_scoped_release release;
  return read_rows(text_of(data), begin, columns);
}

std::vector<SlotTuple> bound_bvh_slots(const nb::bytes& row, std::size_t columns) {
  return tuples(bvh_slots(text_of(row), columns));
}

std::vector<SlotTuple> bound_amc_slots(const nb::bytes& row, const std::vector<nb::bytes>& words,
                                       const std::vector<std::uint32_t>& counts) {
  if (words.size() != counts.size()) throw nb::value_error("words and counts differ");
  std::vector<std::string> texts;
  for (const auto& word : words) texts.emplace_back(text_of(word));
  return tuples(amc_slots(text_of(row), texts, counts));
}

using ColumnTuple = std::tuple<nb::str, std::int32_t, nb::str, nb::str>;

std::vector<ColumnTuple> columns_of(const std::vector<Column>& columns) {
  std::vector<ColumnTuple> list;
  for (const auto& [name, joint, kind, unit] : columns)
    list.emplace_back(text(name), joint, text(kind), text(unit));
  return list;
}

std::vector<ColumnTuple> bound_skeleton_columns(const nb::object& skeleton) {
  return columns_of(skeleton_columns(skeleton_from(skeleton)));
}

std::tuple<std::vector<ColumnTuple>, std::optional<Problem>> bound_bone_columns(
    const nb::object& skeleton, const std::vector<std::pair<nb::str, std::uint32_t>>& bones,
    bool radians) {
  const Skeleton read = skeleton_from(skeleton);
  std::vector<Bone> list;
  for (const auto& [name, count] : bones) list.push_back({utf8_of(name), count});
  std::vector<Column> columns;
  auto fault = bone_columns(&read, list, radians, columns);
  return {columns_of(columns), std::move(fault)};
}

}  // namespace

void bind_formats(nb::module_& module) {
  nb::class_<Problem>(module, "Problem", "What is wrong with a file; None is what is not said.")
      .def_prop_ro("name", [](const Problem& p) { return std::string(p.name); })
      .def_ro("loses_motion", &Problem::loses_motion)
      .def_prop_ro("what", [](const Problem& p) { return text(p.what); })
      .def_prop_ro("line",
                   [](const Problem& p) -> std::optional<std::uint64_t> {
                     return p.line > 0 ? std::optional(p.line) : std::nullopt;
                   })
      .def_prop_ro("offset",
                   [](const Problem& p) -> std::optional<std::int64_t> {
                     return p.offset >= 0 ? std::optional(p.offset) : std::nullopt;
                   })
      .def_prop_ro("expected",
                   [](const Problem& p) -> std::optional<nb::str> {
                     return p.expected.empty() ? std::nullopt : std::optional(text(p.expected));
                   })
      .def_prop_ro("found", [](const Problem& p) -> std::optional<nb::str> {
        return p.found.empty() ? std::nullopt : std::optional(text(p.found));
      });
  nb::class_<Body>(module, "Body",
                   "The rows of a file: see formats/body.hpp. Each array is given once.")
      .def("values", &values_of, "(F, C)")
      .def(
          "counters", [](Body& b) { return taken(b.counters); }, "(F,) or (0,)")
      .def(
          "offsets", [](Body& b) { return taken(b.offsets); }, "(F + 1,)")
      .def(
          "unread", [](Body& b) { return taken(b.unread); }, "Indices of rows.")
      .def("statistics", &statistics_of, "(C, 8)");
  nb::class_<MotionFile>(module, "MotionFile", "A motion file that was read.")
      .def_ro("fault", &MotionFile::fault)
      .def_ro("problems", &MotionFile::problems)
      .def_prop_ro(
          "body", [](MotionFile& m) -> Body& { return m.body; }, nb::rv_policy::reference_internal)
      .def_prop_ro(
          "columns", [](const MotionFile& m) { return columns_of(m.columns); },
          "Name, joint, kind and unit of each.")
      .def_prop_ro(
          "words",
          [](const MotionFile& m) {
            std::vector<nb::bytes> words;
            for (const auto& word : m.words) words.emplace_back(word.data(), word.size());
            return words;
          },
          "AMC: the bones as the file calls them.")
      .def_prop_ro(
          "counts",
          [](const MotionFile& m) {
            std::vector<std::uint32_t> counts;
            for (const Bone& bone : m.bones) counts.push_back(bone.count);
            return counts;
          },
          "AMC: how many numbers each bone has.")
      .def_prop_ro("joints",
                   [](const MotionFile& m) {
                     return m.skeleton ? joints_of(*m.skeleton) : std::vector<JointTuple>();
                   })
      .def_ro("frame_time", &MotionFile::frame_time, "Seconds, or with is_rate a rate; or empty.")
      .def_ro("is_rate", &MotionFile::is_rate);
  nb::class_<SkeletonFile>(module, "SkeletonFile", "A file of a skeleton that was read.")
      .def_ro("fault", &SkeletonFile::fault)
      .def_prop_ro("joints", [](const SkeletonFile& s) { return joints_of(s.skeleton); })
      .def_prop_ro("name", [](const SkeletonFile& s) { return text(s.skeleton.name); })
      .def_prop_ro("mass", [](const SkeletonFile& s) { return text(s.skeleton.mass); })
      .def_prop_ro("radians", [](const SkeletonFile& s) { return s.skeleton.radians; })
      .def_prop_ro("length_unit", [](const SkeletonFile& s) { return s.skeleton.length_unit; });
  const auto data = nb::arg("data");
  module.def("from_utf16", &bound_from_utf16, data, "Give a text in UTF-16 as UTF-8, or None.");
  module.def("read_bvh", &bound_read_bvh, data);
  module.def("read_amc", &bound_read_amc, data, nb::arg("skeleton").none(),
             "Read an AMC, with its Skeleton or None.");
  module.def("read_asf", &bound_read_asf, data);
  module.def("read_rows", &bound_read_rows, data, nb::arg("begin"), nb::arg("columns"),
             "Read rows of so many numbers, a line each, until one differs or the data ends.");
  module.def("bvh_slots", &bound_bvh_slots, nb::arg("row"), nb::arg("columns"),
             "Find the numbers in a row: column, where it begins, where it ends.");
  module.def("amc_slots", &bound_amc_slots, nb::arg("row"), nb::arg("words"), nb::arg("counts"),
             "Find the numbers in a frame, its own number (column -1) first.");
  module.def("skeleton_columns", &bound_skeleton_columns, nb::arg("skeleton"),
             "Give name, joint, kind and unit of the columns of all joints' channels.");
  module.def("bone_columns", &bound_bone_columns, nb::arg("skeleton"), nb::arg("bones"),
             nb::arg("radians"), "Give the columns of bones, or what the skeleton has otherwise.");
}

}  // namespace mocapress
