// Reads motion files for JavaScript (viewer/page/reading/motion_file.js): what it read it says as
// JSON, and numbers stand in its memory.
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coding/record.hpp"
#include "formats/c3d.hpp"
#include "formats/motion_file.hpp"
#include "formats/text.hpp"
#include "wasm/json.hpp"
#include "wasm/space.hpp"

namespace mocapress::wasm {
namespace {

std::string said;
std::vector<double> values;   // of the file that was read last, row by row
std::vector<double> numbers;  // of its skeleton

void say(Json& json, const Problem& problem) {
  json.open('{').key("what").text(problem.what);
  if (!problem.expected.empty()) json.key("expected").text(problem.expected);
  if (!problem.found.empty()) json.key("found").text(problem.found);
  if (problem.line > 0) json.key("line").whole(static_cast<std::int64_t>(problem.line));
  json.key("losesMotion").word(problem.loses_motion ? "true" : "false").close('}');
}

// Of numbers that are not whole JSON says nothing: they stand in `numbers`, first the length unit
// (NaN: none), then of each joint its offset, its axis and its ends.
void say(Json& json, const Skeleton& skeleton) {
  const auto put = [](const Vector& vector) {
    numbers.insert(numbers.end(), vector.begin(), vector.end());
  };
  json.open('{').key("rotation").text(skeleton.fixed ? "fixed" : "moving");
  json.key("angleUnit").text(skeleton.radians ? "rad" : "deg");
  numbers.push_back(skeleton.length_unit.value_or(std::numeric_limits<double>::quiet_NaN()));
  json.key("joints").list(skeleton.joints, [&](const Joint& joint) {
    json.open('{').key("name").text(joint.name).key("parent").whole(joint.parent);
    json.key("channels").list(joint.channels, [&](Kind kind) { json.text(name_of(kind)); });
    json.key("axisOrder").text(joint.axis_order);
    json.key("ends").whole(static_cast<std::int64_t>(joint.ends.size())).close('}');
    put(joint.offset);
    put(joint.axis);
    for (const Vector& end : joint.ends) put(end);
  });
  json.close('}');
}

void say(Json& json, const std::vector<Column>& columns) {
  json.key("columns").list(columns, [&](const Column& column) {
    json.open('{').key("name").text(column.name).key("joint").whole(column.joint);
    json.key("kind").text(column.kind).key("unit").text(column.unit).close('}');
  });
}

void say_fault(Json& json, const Problem& fault, bool of_skeleton) {
  json.key("fault");
  say(json, fault);
  json.key("ofSkeleton").word(of_skeleton ? "true" : "false");
}

// A file as the readers take it: one in UTF-16 becomes UTF-8.
std::string_view readable(std::string_view bytes, std::optional<std::string>& converted) {
  converted = from_utf16(bytes);
  return converted ? std::string_view(*converted) : bytes;
}

void say_file(Json& json, bool bvh, std::string_view file, const Skeleton* skeleton) {
  MotionFile read = bvh ? read_bvh(file) : read_amc(file, skeleton);
  if (read.fault) return say_fault(json, *read.fault, false);
  json.key("problems").list(read.problems, [&](const Problem& problem) { say(json, problem); });
  say(json, read.columns);
  if (read.skeleton) skeleton = &*read.skeleton;
  if (skeleton != nullptr) {
    json.key("skeleton");
    say(json, *skeleton);
  }
  json.key("frames").whole(static_cast<std::int64_t>(read.body.rows()));
  numbers.push_back(read.seconds);
  values = std::move(read.body.values);
}

std::vector<Bone> bones_of(ByteView told) {
  Record record(told);
  std::vector<Bone> bones;
  while (record.left() > 0) {
    const ByteView name = record.bytes();
    bones.push_back({std::string(name.begin(), name.end()),
                     static_cast<std::uint32_t>(record.integer(1 << 20))});
  }
  return bones;
}

void say_bones(Json& json, ByteView told, bool radians, const Skeleton& skeleton) {
  std::vector<Column> columns;
  if (const auto fault = bone_columns(&skeleton, bones_of(told), radians, columns)) {
    return say_fault(json, *fault, false);
  }
  say(json, columns);
  json.key("skeleton");
  say(json, skeleton);
}

void say(Json& json, std::string_view name, const C3dFrames& frames) {
  json.key(name).open('[');
  for (const std::uint64_t number : {frames.begin, frames.count, frames.numbers}) {
    json.whole(static_cast<std::int64_t>(number));
  }
  json.close(']');
}

void say(Json& json, const C3dLayout& layout) {
  const auto say_whole = [&](std::string_view name, std::uint64_t number) {
    json.key(name).whole(static_cast<std::int64_t>(number));
  };
  json.open('{');
  say_whole("processor", static_cast<std::uint64_t>(layout.processor));
  json.key("floats").word(layout.floats ? "true" : "false");
  say_whole("announced", layout.announced);
  say_whole("points", layout.points);
  say_whole("analog", layout.analog);
  say_whole("samples", layout.samples);
  say(json, "frames", layout.frames);
  say(json, "rotations", layout.rotations);
  json.key("parameters").list(layout.parameters, [&](const C3dParameter& parameter) {
    json.open('{').key("group").whole(parameter.group);
    json.key("isGroup").word(parameter.is_group ? "true" : "false");
    json.key("name").text(parameter.name).key("type").whole(parameter.type);
    json.key("dimensions").list(parameter.dimensions, [&](std::uint8_t size) { json.whole(size); });
    say_whole("begin", parameter.begin);
    say_whole("size", parameter.size);
    json.close('}');
  });
  json.close('}');
}

template <class Work>
const char* answer(std::optional<std::string_view> asf, Work work) {
  Json json;
  json.open('{');
  numbers.clear();
  std::optional<std::string> converted;
  std::optional<SkeletonFile> skeleton;
  if (asf) skeleton = read_asf(readable(*asf, converted));
  if (skeleton && skeleton->fault) {
    say_fault(json, *skeleton->fault, true);
  } else {
    work(json, skeleton ? &skeleton->skeleton : nullptr);
  }
  json.close('}');
  said = json.printed();
  return said.data();
}

}  // namespace
}  // namespace mocapress::wasm

using namespace mocapress;
using namespace mocapress::wasm;

extern "C" {

// Reads a BVH, or an AMC, with its ASF or without, of these sizes, which stand in the space one
// behind the other. Gives JSON, of `said` bytes.
[[clang::export_name("read")]] const char* mocapress_read(bool bvh, std::size_t size, bool has_asf,
                                                          std::size_t asf) {
  const std::string_view all(reinterpret_cast<const char*>(space().data()), size + asf);
  const auto beside = has_asf ? std::optional(all.substr(size)) : std::nullopt;
  return answer(beside, [&](Json& json, const Skeleton* skeleton) {
    std::optional<std::string> converted;
    say_file(json, bvh, readable(all.substr(0, size), converted), skeleton);
  });
}

// Reads an ASF, and finds its joints for bones: `bytes` name and `int` count of each.
[[clang::export_name("bones")]] const char* mocapress_bones(std::size_t asf, std::size_t bones,
                                                            bool radians) {
  const std::string_view all(reinterpret_cast<const char*>(space().data()), asf);
  const ByteView told(reinterpret_cast<const std::uint8_t*>(space().data()) + asf, bones);
  return answer(all, [&](Json& json, const Skeleton* skeleton) {
    say_bones(json, told, radians, *skeleton);
  });
}

// Finds how a C3D of this size, which stands in the space, is laid out.
[[clang::export_name("c3d")]] const char* mocapress_c3d(std::size_t size) {
  Json json;
  say(json, c3d_layout({reinterpret_cast<const std::uint8_t*>(space().data()), size}, size));
  said = json.printed();
  return said.data();
}

[[clang::export_name("said")]] std::size_t mocapress_said() { return said.size(); }

// The numbers of the skeleton that was read last, and last its frame time in seconds, or 0.
[[clang::export_name("numbers")]] const double* mocapress_numbers() { return numbers.data(); }
[[clang::export_name("count")]] std::size_t mocapress_count() { return numbers.size(); }

// The numbers of the file, row by row.
[[clang::export_name("values")]] const double* mocapress_values() { return values.data(); }

}  // extern "C"
