#include "formats/columns.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "formats/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kJointsNamed = 8;  // in a message
constexpr std::size_t kRootValues = 6;

using Places = std::unordered_map<std::string, std::vector<std::int32_t>>;

std::string_view unit_of(std::string_view kind, bool radians) {
  if (kind[0] == 'r') return radians ? "rad" : "deg";
  return kind[0] == 't' || kind[0] == 'l' ? "length" : "";
}

// Lower case of ASCII and ISO 8859-1, in UTF-8.
std::string folded(std::string_view name) {
  std::string out = lower(name);
  for (std::size_t i = 0; i + 1 < out.size(); ++i) {
    const auto byte = static_cast<unsigned char>(out[i + 1]);
    if (out[i] == '\xc3' && byte >= 0x80 && byte < 0x9F && byte != 0x97)
      out[i + 1] = static_cast<char>(byte + 0x20);
  }
  return out;
}

// Appends the columns of the n-th bone of a name.
template <class Kinds>
void append(std::vector<Column>& columns, const std::string& name, unsigned nth, std::int32_t joint,
            const Kinds& kinds, bool radians) {
  const std::string label = nth == 1 ? name : name + '#' + std::to_string(nth);
  for (const std::string_view kind : kinds) {
    Column column{label, joint, std::string(kind), unit_of(kind, radians)};
    column.name.append(".").append(kind);
    columns.push_back(std::move(column));
  }
}

std::vector<std::string_view> names_of(const std::vector<Kind>& kinds) {
  std::vector<std::string_view> names;
  names.reserve(kinds.size());
  for (const Kind kind : kinds) names.push_back(name_of(kind));
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

Problem no_such_bone(const Skeleton& skeleton, const std::string& name) {
  std::string some;
  const std::size_t count = std::min(skeleton.joints.size(), kJointsNamed);
  for (std::size_t i = 0; i < count; ++i) some += shown(skeleton.joints[i].name) + ", ";
  return {.what = "the skeleton has no bone " + shown(name),
          .expected = some + "…",
          .found = quoted(name)};
}

}  // namespace

std::vector<Column> skeleton_columns(const Skeleton& skeleton) {
  std::vector<Column> columns;
  std::unordered_map<std::string, unsigned> seen;
  for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
    const Joint& joint = skeleton.joints[i];
    if (joint.channels.empty()) continue;
    append(columns, joint.name, ++seen[joint.name], static_cast<std::int32_t>(i),
           names_of(joint.channels), skeleton.radians);
  }
  return columns;
}

std::optional<Problem> bone_columns(const Skeleton* skeleton, std::span<const Bone> bones,
                                    bool radians, std::vector<Column>& columns) {
  Places exact;
  Places any_case;
  if (skeleton != nullptr) {
    for (const bool without : {false, true}) {
      for (std::size_t i = 0; i < skeleton->joints.size(); ++i) {
        const Joint& joint = skeleton->joints[i];
        if (joint.channels.empty() != without) continue;
        exact[joint.name].push_back(static_cast<std::int32_t>(i));
        any_case[folded(joint.name)].push_back(static_cast<std::int32_t>(i));
      }
    }
  }
  std::unordered_map<std::string, unsigned> seen;
  for (std::size_t place = 0; place < bones.size(); ++place) {
    const auto& [name, count] = bones[place];
    const unsigned nth = ++seen[name];
    auto joint = static_cast<std::int32_t>(place);
    std::vector<std::string> kinds;
    kinds.reserve(count);
    for (std::uint32_t k = 0; k < count; ++k) kinds.push_back('v' + std::to_string(k + 1));
    if (skeleton != nullptr) {
      const auto named = exact.find(name);
      const auto like = any_case.find(folded(name));
      const auto* const found = named != exact.end()     ? &named->second
                                : like != any_case.end() ? &like->second
                                                         : nullptr;
      if (found == nullptr || nth > found->size()) return no_such_bone(*skeleton, name);
      joint = (*found)[nth - 1];
      const auto& channels = skeleton->joints[static_cast<std::size_t>(joint)].channels;
      // Values of a bone without degrees of freedom are kept, and move nothing.
      if (!channels.empty()) {
        const auto names = names_of(channels);
        kinds.assign(names.begin(), names.end());
      }
      if (kinds.size() != count) {
        return Problem{.what = "values of bone " + shown(name),
                       .expected = std::to_string(kinds.size()) + " (" + joined(kinds) +
                                   "), as the skeleton has",
                       .found = std::to_string(count)};
      }
    } else if (place == 0 && count == kRootValues) {
      for (std::size_t k = 0; k < kRootValues; ++k) kinds[k] = kKindNames[k];
    }
    append(columns, name, nth, joint, kinds, radians);
  }
  return {};
}

}  // namespace mocapress
