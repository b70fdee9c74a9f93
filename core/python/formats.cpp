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

#include "formats/detect.hpp"
#include "formats/header_pattern.hpp"
#include "formats/motion_file.hpp"
#include "formats/rows.hpp"
#include "formats/text.hpp"
#include "python/bindings.hpp"
#include "python/number_formats.hpp"
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

constexpr std::size_t kStatistics = 11;

Given<std::uint8_t, 2> statistics_of(const Body& body) {
  std::vector<std::uint8_t> statistics;
  for (const auto& column : body.statistics)
    statistics.insert(
        statistics.end(),
        {column.least_decimals, column.most_decimals, column.most_significant,
         column.exponent_digits, column.trailing_zero, column.whole_without_point,
         column.bare_point, column.upper, column.plus, column.leading_zero, column.end_point});
  return give(std::move(statistics), std::array{body.columns, kStatistics});
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

// Where the numbers of some rows stand in a file: (R, C, 2) begin and end, -1 where a row has none.
Given<std::int64_t, 3> bound_places(const MotionFile& file, const nb::bytes& data,
                                    const Input<std::uint64_t, 1>& offsets,
                                    const Input<std::int64_t, 1>& rows) {
  const std::string_view text = text_of(data);
  const std::size_t columns = file.columns.size();
  std::vector<std::uint32_t> counts;
  for (const Bone& bone : file.bones) counts.push_back(bone.count);
  std::vector<std::int64_t> places(rows.shape(0) * columns * 2, -1);
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    const auto row = static_cast<std::size_t>(rows.data()[i]);
    if (row + 1 >= offsets.shape(0)) throw std::out_of_range("no such row");
    const std::uint64_t begin = offsets.data()[row];
    const std::uint64_t end = offsets.data()[row + 1];
    if (begin > end || end > text.size()) throw std::out_of_range("row outside the data");
    const auto bytes = text.substr(begin, end - begin);
    const auto slots =
        file.skeleton ? bvh_slots(bytes, columns) : amc_slots(bytes, file.words, counts);
    for (const Slot& slot : slots) {
      if (slot.column < 0 || static_cast<std::size_t>(slot.column) >= columns) continue;
      std::int64_t* const place =
          places.data() + 2 * (i * columns + static_cast<std::size_t>(slot.column));
      place[0] = static_cast<std::int64_t>(begin + slot.begin);
      place[1] = static_cast<std::int64_t>(begin + slot.end);
    }
  }
  return give(std::move(places), std::array{rows.shape(0), columns, std::size_t{2}});
}

Given<std::uint8_t, 2> bound_detect_formats(const nb::bytes& data,
                                            const Plan<std::uint8_t, 11>& statistics,
                                            const Input<double, 2>& values,
                                            const Input<std::int64_t, 3>& places) {
  const std::string_view text = text_of(data);
  const std::size_t columns = statistics.shape(0);
  if (values.shape(1) != columns || places.shape(0) != values.shape(0) ||
      places.shape(1) != columns || places.shape(2) != 2)
    throw nb::value_error("arrays of mismatched lengths");
  std::vector<ColumnStatistics> list;
  for (std::size_t c = 0; c < columns; ++c) {
    const std::uint8_t* const s = statistics.data() + kStatistics * c;
    list.push_back({s[0], s[1], s[2], s[3], s[4] != 0, s[5] != 0, s[6] != 0, s[7] != 0, s[8] != 0,
                    s[9] != 0, s[10] != 0});
  }
  Sample sample;
  sample.values.assign(values.data(), values.data() + values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto begin = places.data()[2 * i];
    const auto end = places.data()[2 * i + 1];
    if (begin > end || end > static_cast<std::int64_t>(text.size()))
      throw std::out_of_range("a number outside the data");
    sample.texts.push_back(begin < 0 ? std::string_view()
                                     : text.substr(static_cast<std::size_t>(begin),
                                                   static_cast<std::size_t>(end - begin)));
  }
  return packed(detect_formats(list, sample));
}

using Words = std::vector<std::optional<nb::bytes>>;

HeaderReferences references(const Words& names, const Words& channels,
                            const Input<double, 1>& numbers, const nb::bytes& time,
                            std::uint64_t rows) {
  const auto texts = [](const Words& words) {
    std::vector<std::optional<std::string>> list;
    for (const auto& word : words)
      list.push_back(word ? std::optional<std::string>(text_of(*word)) : std::nullopt);
    return list;
  };
  return {texts(names),
          texts(channels),
          {numbers.data(), numbers.data() + numbers.size()},
          std::string(text_of(time)),
          rows};
}

std::tuple<nb::bytes, Given<std::uint8_t, 2>> bound_header_pattern(
    const nb::bytes& header, const Words& names, const Words& channels,
    const Input<double, 1>& numbers, const nb::bytes& time, std::uint64_t rows,
    const nb::bytes& line_break, const nb::bytes& indentation) {
  const HeaderStyle style{std::string(text_of(line_break)), std::string(text_of(indentation)), {}};
  if (style.line_break.empty()) throw nb::value_error("no line break");
  const auto [pattern, formats] =
      header_pattern(text_of(header), references(names, channels, numbers, time, rows), style);
  return {nb::bytes(pattern.data(), pattern.size()), packed(formats)};
}

nb::bytes bound_print_header(const nb::bytes& pattern, const Words& names, const Words& channels,
                             const Input<double, 1>& numbers, const nb::bytes& time,
                             std::uint64_t rows, const nb::bytes& line_break,
                             const nb::bytes& indentation, const Formats& formats,
                             std::uint64_t most) {
  const HeaderStyle style{std::string(text_of(line_break)), std::string(text_of(indentation)),
                          number_formats(formats)};
  const char* why = nullptr;
  const auto header = print_header(
      text_of(pattern), references(names, channels, numbers, time, rows), style, most, why);
  if (!header) throw nb::value_error(why);
  return nb::bytes(header->data(), header->size());
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
      .def("statistics", &statistics_of, "(C, 11)");
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
      .def("places", &bound_places, nb::arg("data"), nb::arg("offsets"), nb::arg("rows"),
           "Give where the numbers of some rows stand: (R, C, 2) begin and end, or -1.")
      .def_ro("frame_time", &MotionFile::frame_time, "Seconds, or with is_rate a rate; or empty.")
      .def_ro("is_rate", &MotionFile::is_rate);
  nb::class_<SkeletonFile>(module, "SkeletonFile", "A file of a skeleton that was read.")
      .def_ro("fault", &SkeletonFile::fault)
      .def_prop_ro("joints", [](const SkeletonFile& s) { return joints_of(s.skeleton); })
      .def_prop_ro("name", [](const SkeletonFile& s) { return text(s.skeleton.name); })
      .def_prop_ro("mass",
                   [](const SkeletonFile& s) { return text(decoded_name(s.skeleton.mass)); })
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
  module.def("detect_formats", &bound_detect_formats, data, nb::arg("statistics"),
             nb::arg("values"), nb::arg("places"),
             "Choose a format per column from some rows, (R, C), and where their numbers stand,\n"
             "(R, C, 2): four bytes each, as docs/format/layout.md has them.");
  const auto names = nb::arg("names");
  const auto channels = nb::arg("channels");
  const auto numbers = nb::arg("numbers");
  const auto time = nb::arg("time");
  const auto rows = nb::arg("rows");
  const auto line_break = nb::arg("line_break");
  const auto indentation = nb::arg("indentation");
  module.def("header_pattern", &bound_header_pattern, nb::arg("header"), names, channels, numbers,
             time, rows, line_break, indentation,
             "Give the shortest pattern of a header, and the formats that it needs.");
  module.def("print_header", &bound_print_header, nb::arg("pattern"), names, channels, numbers,
             time, rows, line_break, indentation, nb::arg("formats"), nb::arg("most"),
             "Give the header of a pattern; ValueError where it refers to what is not there.");
  module.def("skeleton_columns", &bound_skeleton_columns, nb::arg("skeleton"),
             "Give name, joint, kind and unit of the columns of all joints' channels.");
  module.def("bone_columns", &bound_bone_columns, nb::arg("skeleton"), nb::arg("bones"),
             nb::arg("radians"), "Give the columns of bones, or what the skeleton has otherwise.");
}

}  // namespace mocapress
