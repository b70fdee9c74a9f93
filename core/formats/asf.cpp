// ASF: an Acclaim skeleton.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "formats/motion_file.hpp"
#include "formats/text.hpp"
#include "numbers/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kNone = SIZE_MAX;

struct Line {
  std::uint64_t number = 0;
  std::string key;                      // the first word, lower case
  std::vector<std::string_view> words;  // the others
  std::string text;                     // all words
};

struct AsfBone {
  std::string name = {};  // as the file has it
  std::uint64_t line = 0;
  Vector vector{};
  Vector axis{};
  std::string axis_order = "xyz";
  std::vector<Kind> channels = {};
  std::vector<std::pair<double, double>> limits = {};
  Vector position{};
  std::size_t parent = kNone;
};

std::string joined(const std::vector<std::string_view>& words) {
  std::string out;
  for (const std::string_view word : words) out.append(out.empty() ? "" : " ").append(word);
  return out;
}

double length_of(const Vector& vector) {
  const double largest =
      std::max({std::fabs(vector[0]), std::fabs(vector[1]), std::fabs(vector[2])});
  if (largest > 1e-100 && largest < 1e100) return std::sqrt(dot(vector, vector));
  if (largest == 0) return 0;
  const Vector small = {vector[0] / largest, vector[1] / largest, vector[2] / largest};
  return largest * std::sqrt(dot(small, small));
}

// Bones by name. Where names repeat, each mention as a child means the next such bone.
class Names {
 public:
  void add(const std::string& name) { by_name_[name].bones.push_back(count_++); }
  bool has(const std::string& name) const { return by_name_.contains(name); }
  // The first that has no parent yet.
  std::size_t loose(const std::string& name, const std::vector<bool>& linked) {
    Group& group = by_name_[name];
    while (group.next < group.bones.size() && linked[group.bones[group.next]]) ++group.next;
    return group.next < group.bones.size() ? group.bones[group.next] : kNone;
  }
  // The last that has one, otherwise the first.
  std::size_t parent(const std::string& name) {
    const Group& group = by_name_[name];
    return group.last == kNone ? group.bones.front() : group.last;
  }
  void link(const std::string& name, std::size_t bone) {
    Group& group = by_name_[name];
    group.last = group.last == kNone ? bone : std::max(group.last, bone);
  }

 private:
  struct Group {
    std::vector<std::size_t> bones;
    std::size_t next = 0;
    std::size_t last = kNone;
  };
  std::unordered_map<std::string, Group> by_name_;
  std::size_t count_ = 0;
};

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  SkeletonFile read() {
    Line line;
    while (!made_.fault && next(line)) take(line);
    if (!made_.fault && !rooted_) fail(1, "no root", "a section :root");
    if (!made_.fault) link();
    if (!made_.fault) finish();
    return std::move(made_);
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::uint64_t number_ = 0;
  SkeletonFile made_;
  std::map<std::string, std::string> units_;
  std::string section_;
  std::string name_;
  std::string root_name_ = "root";
  bool rooted_ = false;
  std::vector<AsfBone> bones_ = {{.name = "root"}};
  std::vector<Line> links_;

  void fail(std::uint64_t line, std::string what, std::string expected, std::string found = "") {
    if (made_.fault) return;
    made_.fault = Problem{.what = std::move(what),
                          .expected = std::move(expected),
                          .found = std::move(found),
                          .line = line};
  }

  bool next(Line& line) {
    while (at_ < text_.size()) {
      const std::size_t end = end_of_line(text_, at_);
      const std::string_view all = text_.substr(at_, end - at_);
      at_ = next_line(text_, end);
      ++number_;
      auto words = words_of(all.substr(0, all.find('#')));
      if (words.empty()) continue;
      line.number = number_;
      line.key = lower(words.front());
      line.text = joined(words);
      // In the documentation: the name of a root that is called otherwise.
      if (words.front() == "mocapress-root" && words.size() > 1 && root_name_ == "root")
        root_name_ = words[1];
      words.erase(words.begin());
      line.words = std::move(words);
      return true;
    }
    return false;
  }

  void take(const Line& line) {
    if (line.key.starts_with(':')) {
      section_ = line.key;
      if (section_ == ":name") name_ = decoded_name(joined(line.words));
      if (section_ == ":root") {
        if (rooted_) return fail(line.number, "a second root", "one section :root");
        rooted_ = true;
        bones_.front().line = line.number;
      }
    } else if (section_ == ":units" && !line.words.empty()) {
      units_[line.key] = line.words.front();
    } else if (section_ == ":root") {
      root_line(bones_.front(), line);
    } else if (section_ == ":bonedata" && line.key == "begin") {
      bone(line.number);
    } else if (section_ == ":hierarchy" && line.key != "begin" && line.key != "end") {
      links_.push_back(line);
    }
  }

  void root_line(AsfBone& root, const Line& line) {
    if (line.key == "order") {
      channels(line, root.channels);
    } else if (line.key == "axis" && !line.words.empty()) {
      order(line, line.words.back(), root.axis_order);
    } else if (line.key == "position") {
      vector(line, root.position);
    } else if (line.key == "orientation") {
      vector(line, root.axis);
    }
  }

  void bone(std::uint64_t begin) {
    AsfBone bone;
    bone.line = begin;
    Vector direction{};
    double length = 0;
    std::string limits;
    Line line;
    while (true) {
      if (!next(line)) return fail(begin, "a bone without end", "end", "the end of the file");
      if (line.key == "end") break;
      if (line.key.starts_with(':'))
        return fail(line.number, "a bone without end", "end", quoted(line.text));
      if (line.key == "name") {
        bone.name = joined(line.words);
      } else if (line.key == "direction") {
        vector(line, direction);
      } else if (line.key == "length") {
        number(line, line.words.empty() ? "" : line.words.front(), length);
      } else if (line.key == "axis") {
        vector(line, bone.axis);
        order(line, line.words.size() > 3 ? line.words[3] : "xyz", bone.axis_order);
      } else if (line.key == "dof") {
        channels(line, bone.channels);
      } else if (line.key == "limits" || line.key.starts_with('(')) {
        limits += line.text;
      }
    }
    if (bone.name.empty()) return fail(begin, "a bone without a name", "name");
    // Only the direction of `direction` counts: files exist where it is not of unit length.
    const double size = length_of(direction);
    bone.vector = scaled(direction, length / (size > 0 ? size : 1));
    take_limits(begin, limits, bone.limits);
    bones_.push_back(std::move(bone));
  }

  // Pairs in brackets, with blanks or commas between.
  void take_limits(std::uint64_t line, std::string_view text,
                   std::vector<std::pair<double, double>>& limits) {
    for (std::size_t at = text.find('('); at != std::string_view::npos; at = text.find('(', at)) {
      const std::size_t end = text.find_first_of("()", ++at);
      if (end == std::string_view::npos) return;
      if (text[end] == '(') continue;
      std::string inside(text.substr(at, end - at));
      std::replace(inside.begin(), inside.end(), ',', ' ');
      const auto words = words_of(inside);
      if (words.size() != 2) continue;
      double bounds[2];
      for (std::size_t k = 0; k < 2; ++k) {
        const char* const first = words[k].data();
        const char* const last = first + words[k].size();
        NumberShape shape;
        const char* rest = parse_number(first, last, bounds[k], shape);
        if (rest != last) rest = parse_non_finite(first, last, bounds[k], shape);
        if (rest != last) return fail(line, "limits", "a number or inf", quoted(words[k]));
      }
      limits.emplace_back(bounds[0], bounds[1]);
    }
  }

  void channels(const Line& line, std::vector<Kind>& channels) {
    channels.clear();
    bool good = true;
    for (const std::string_view word : line.words) {
      const auto end = kKindNames.begin() + static_cast<std::size_t>(Kind::sx);
      const auto* const found = std::find(kKindNames.begin(), end, lower(word));
      const auto kind = static_cast<Kind>(found - kKindNames.begin());
      good = good && found != end &&
             std::find(channels.begin(), channels.end(), kind) == channels.end();
      if (!good) break;
      channels.push_back(kind);
    }
    if (!good) {
      fail(line.number, shown(line.key), "each of tx ty tz rx ry rz l at most once",
           quoted(line.text));
    }
  }

  void order(const Line& line, std::string_view word, std::string& order) {
    std::string sorted = order = lower(word);
    std::sort(sorted.begin(), sorted.end());
    if (sorted != "xyz")
      fail(line.number, "order of axes", "x, y and z in some order", quoted(word));
  }

  void vector(const Line& line, Vector& vector) {
    if (line.words.size() < 3)
      return fail(line.number, shown(line.key), "three numbers", quoted(line.text));
    for (std::size_t k = 0; k < 3; ++k) number(line, line.words[k], vector[k]);
  }

  void number(const Line& line, std::string_view word, double& number) {
    const auto read = finite_number(word);
    if (!read) return fail(line.number, shown(line.key), "a number", quoted(word));
    number = *read;
  }

  void link() {
    Names exact;
    Names any_case;
    for (const AsfBone& bone : bones_) {
      exact.add(bone.name);
      any_case.add(lower(bone.name));
    }
    std::vector<bool> linked(bones_.size());
    const auto link_bone = [&](std::size_t bone) {
      linked[bone] = true;
      exact.link(bones_[bone].name, bone);
      any_case.link(lower(bones_[bone].name), bone);
    };
    link_bone(0);
    for (const Line& line : links_) {
      std::size_t parent = kNone;
      auto words = words_of(line.text);
      for (const std::string_view word : words) {
        std::string name(word);
        Names* names = &exact;
        if (!exact.has(name)) names = &any_case, name = lower(word);
        if (!names->has(name))
          return fail(line.number, "hierarchy", "the name of a bone", quoted(word));
        if (parent == kNone) {
          parent = names->parent(name);
          continue;
        }
        const std::size_t child = names->loose(name, linked);
        if (child == kNone)
          return fail(line.number, "hierarchy", "a bone without a parent", quoted(word));
        bones_[child].parent = parent;
        link_bone(child);
      }
    }
  }

  // The bones, parents before their children; those that do not hang on the root are left out.
  std::vector<std::size_t> depth_first(const std::vector<std::vector<std::size_t>>& children) {
    std::vector<std::size_t> order;
    std::vector<std::size_t> stack = {0};
    while (!stack.empty()) {
      const std::size_t i = stack.back();
      stack.pop_back();
      order.push_back(i);
      stack.insert(stack.end(), children[i].rbegin(), children[i].rend());
    }
    return order;
  }

  void finish() {
    std::vector<std::vector<std::size_t>> children(bones_.size());
    bool in_order = true;
    for (std::size_t i = 1; i < bones_.size(); ++i) {
      const std::size_t parent = bones_[i].parent;
      if (parent != kNone) children[parent].push_back(i);
      in_order = in_order && parent < i;
    }
    std::vector<std::size_t> order = depth_first(children);
    if (order.size() < bones_.size()) {
      std::vector<bool> reached(bones_.size());
      for (const std::size_t i : order) reached[i] = true;
      const auto loose = static_cast<std::size_t>(std::find(reached.begin(), reached.end(), false) -
                                                  reached.begin());
      return fail(bones_[loose].line, "bone " + shown(decoded_name(bones_[loose].name)),
                  "a way to root in :hierarchy");
    }
    if (in_order) std::sort(order.begin(), order.end());
    take_units();
    std::vector<std::int32_t> place(bones_.size(), -1);
    for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<std::int32_t>(k);
    bones_.front().name = root_name_;
    Skeleton& skeleton = made_.skeleton;
    skeleton.fixed = true;
    skeleton.name = name_;
    for (const std::size_t i : order) {
      AsfBone& bone = bones_[i];
      Joint joint;
      joint.name = decoded_name(bone.name);
      joint.parent = i == 0 ? -1 : place[bone.parent];
      joint.offset = i == 0 ? bone.position : bones_[bone.parent].vector;
      joint.channels = std::move(bone.channels);
      joint.axis = bone.axis;
      joint.axis_order = bone.axis_order;
      joint.limits = std::move(bone.limits);
      if (i > 0 && children[i].empty()) joint.ends = {bone.vector};
      skeleton.joints.push_back(std::move(joint));
    }
  }

  void take_units() {
    const auto told = [&](const char* key) {
      const auto found = units_.find(key);
      return found == units_.end() ? std::string() : found->second;
    };
    const std::string angle = lower(told("angle"));
    if (!angle.empty() && angle != "deg" && angle != "rad")
      fail(1, "unit of angles", "deg or rad", quoted(angle));
    made_.skeleton.radians = angle == "rad";
    made_.skeleton.mass = told("mass");
    if (!units_.contains("length")) return;
    const auto length = finite_number(told("length"));
    if (!length || *length <= 0)
      return fail(1, "unit of length", "a number above 0", quoted(told("length")));
    made_.skeleton.length_unit = length;
  }
};

}  // namespace

SkeletonFile read_asf(std::string_view text) { return Reader(text).read(); }

}  // namespace mocapress
