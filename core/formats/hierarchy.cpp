#include "formats/hierarchy.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "formats/text.hpp"
#include "numbers/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kMostJoints = 65536;
constexpr std::size_t kMostListed = 99;  // channels whose words may stand on several lines
constexpr std::uint64_t kMostFrames = std::uint64_t{1} << 40;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

constexpr std::array<std::pair<std::string_view, Kind>, 9> kWords = {{
    {"xposition", Kind::tx},
    {"yposition", Kind::ty},
    {"zposition", Kind::tz},
    {"xrotation", Kind::rx},
    {"yrotation", Kind::ry},
    {"zrotation", Kind::rz},
    {"xscale", Kind::sx},
    {"yscale", Kind::sy},
    {"zscale", Kind::sz},
}};

// A joint whose brace is open.
struct Open {
  std::string name;
  std::int32_t parent = -1;
  bool end_site = false;
  Vector offset{};
  std::int32_t index = -1;
};

using Words = std::vector<std::string_view>;

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  Hierarchy read() {
    while (!made_.fault && !done_) step();
    return std::move(made_);
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;        // of the piece
  std::size_t position_ = 0;  // behind it
  Hierarchy made_;
  std::vector<Open> stack_;
  std::optional<Open> waiting_;  // a joint whose brace is to come
  bool done_ = false;

  std::vector<Joint>& joints() { return made_.skeleton.joints; }

  void fail(std::size_t offset, std::string what, std::string expected) {
    const std::size_t end = std::min(end_of_line(text_, offset), offset + 40);
    const std::string_view found = trimmed(text_.substr(offset, end - offset));
    const bool ended = trimmed(text_.substr(offset)).empty();
    made_.fault = Problem{.what = std::move(what),
                          .expected = std::move(expected),
                          .found = !found.empty() ? quoted(found)
                                   : ended        ? "the end of the file"
                                                  : "the end of the line",
                          .line = line_of(text_, offset),
                          .offset = static_cast<std::int64_t>(offset)};
  }

  // A brace, or what stands before the next one or the end of the line. False at the end.
  bool next_piece(std::string_view& piece) {
    at_ = position_;
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    if (at_ == text_.size()) return false;
    position_ = at_ + 1;
    const auto goes_on = [&] {
      return position_ < text_.size() && !is_line_end(text_[position_]) &&
             !is_brace(text_[position_]);
    };
    while (!is_brace(text_[at_]) && goes_on()) ++position_;
    piece = text_.substr(at_, position_ - at_);
    return true;
  }
  static bool is_brace(char c) { return c == '{' || c == '}'; }

  void step() {
    std::string_view piece;
    if (!next_piece(piece)) return fail(text_.size(), "no motion", "MOTION");
    if (piece.starts_with(kByteOrderMark)) piece.remove_prefix(kByteOrderMark.size());
    piece = trimmed(piece);
    if (piece.empty() || piece.starts_with('#') || piece.starts_with("//")) {
      position_ = end_of_line(text_, at_);
      return;
    }
    Words words = words_of(piece);
    const std::string key = lower(words.front());
    words.erase(words.begin());
    if (waiting_ && key != "{") return fail(at_, "joint " + shown(waiting_->name), "{");
    if (key == "motion") return motion();
    if (key == "{") return open();
    if (key == "}") return close();
    if (key == "root" || key == "joint" || key == "end") {
      return begin(key, decoded_name(trimmed(piece.substr(key.size()))));
    }
    const std::size_t at = at_;
    add_words(key, words);
    at_ = at;
    if (key == "offset") return offset(words);
    if (key == "channels") return channels(words);
    if (key != "hierarchy")
      fail(at_, "hierarchy", "ROOT, JOINT, End Site, OFFSET, CHANNELS or a brace");
  }

  // Appends the words of the next lines, where OFFSET or CHANNELS go on there.
  void add_words(const std::string& key, Words& words) {
    std::size_t needed = key == "offset" ? 3 : 0;
    if (key == "channels" && !words.empty()) {
      std::size_t count = 0;
      for (const char c : words.front().substr(0, 3)) {
        if (!is_digit(c)) return;
        count = 10 * count + static_cast<std::size_t>(c - '0');
      }
      needed = 1 + std::min(count, kMostListed);
    }
    while (words.size() < needed) {
      const std::size_t before = position_;
      std::string_view piece;
      if (!next_piece(piece) || is_brace(piece.front())) {
        position_ = before;
        return;
      }
      for (const std::string_view word : words_of(piece)) words.push_back(word);
    }
  }

  void begin(const std::string& key, std::string name) {
    const bool root = key == "root";
    if (root == !stack_.empty() || (!stack_.empty() && stack_.back().end_site)) {
      std::string word = key;
      for (char& c : word) c = static_cast<char>(c - 'a' + 'A');
      return fail(at_, word + " in the wrong place", "ROOT outside, JOINT inside of a joint");
    }
    if (joints().size() >= kMostJoints)
      return fail(at_, "too many joints", "at most " + std::to_string(kMostJoints));
    Open made{std::move(name), stack_.empty() ? -1 : stack_.back().index, key == "end"};
    if (!made.end_site) {
      made.index = static_cast<std::int32_t>(joints().size());
      Joint joint;
      joint.name = made.name;
      joint.parent = made.parent;
      joints().push_back(std::move(joint));
    }
    waiting_ = std::move(made);
  }

  void open() {
    if (!waiting_) return fail(at_, "a brace without a joint", "ROOT, JOINT or End Site");
    stack_.push_back(std::move(*waiting_));
    waiting_.reset();
  }

  void close() {
    if (stack_.empty()) return fail(at_, "a brace too many", "MOTION");
    const Open closed = std::move(stack_.back());
    stack_.pop_back();
    if (closed.end_site)
      joints()[static_cast<std::size_t>(closed.parent)].ends.push_back(closed.offset);
  }

  void offset(const Words& words) {
    Vector read{};
    bool good = words.size() == 3 && !stack_.empty();
    for (std::size_t k = 0; good && k < 3; ++k) {
      const auto number = finite_number(words[k]);
      good = number.has_value();
      read[k] = number.value_or(0);
    }
    if (!good) return fail(at_, "offset", "OFFSET and three numbers, inside of a joint");
    Open& here = stack_.back();
    here.offset = read;
    if (!here.end_site) joints()[static_cast<std::size_t>(here.index)].offset = read;
  }

  void channels(const Words& words) {
    std::vector<Kind> kinds;
    bool good = !words.empty();
    for (std::size_t i = 1; good && i < words.size(); ++i) {
      const std::string word = lower(words[i]);
      const auto* const found = std::find_if(kWords.begin(), kWords.end(),
                                             [&](const auto& w) { return w.first == word; });
      good = found != kWords.end();
      if (good) kinds.push_back(found->second);
    }
    std::string_view count = words.empty() ? "" : words.front();
    while (count.size() > 1 && count.front() == '0') count.remove_prefix(1);
    if (!good || count != std::to_string(kinds.size()))
      return fail(at_, "channels", "their number, and as many names like Xrotation");
    std::vector<Kind> seen;  // a rotation may be given twice: Euler angles X, Y, X
    for (const Kind kind : kinds) {
      good = good && std::find(seen.begin(), seen.end(), kind) == seen.end();
      if (!is_rotation(kind)) seen.push_back(kind);
    }
    if (!good || stack_.empty() || stack_.back().end_site)
      return fail(at_, "channels", "each position at most once, inside of a joint");
    joints()[static_cast<std::size_t>(stack_.back().index)].channels = std::move(kinds);
  }

  // Passes `words`, in any case and with blanks between, and a colon; gives the word behind it.
  std::string_view declared(std::size_t& at, std::initializer_list<std::string_view> words) const {
    std::size_t ahead = at;
    const auto skip = [&] {
      while (ahead < text_.size() && is_space(text_[ahead])) ++ahead;
    };
    for (const std::string_view word : words) {
      skip();
      if (!same_word(text_.substr(ahead, word.size()), word)) return {};
      ahead += word.size();
    }
    skip();
    const std::size_t begin = ahead;
    while (ahead < text_.size() && !is_space(text_[ahead])) ++ahead;
    if (ahead > begin) at = next_line(text_, ahead);
    return text_.substr(begin, ahead - begin);
  }

  void motion() {
    if (!stack_.empty() || joints().empty())
      return fail(at_, "the hierarchy is not complete", stack_.empty() ? "ROOT" : "}");
    while (position_ < text_.size() && is_space(text_[position_])) ++position_;
    std::size_t at = position_;
    std::string_view count = declared(at, {"frames", ":"});
    if (count.empty()) return fail(position_, "number of frames", "Frames: and their number");
    while (count.size() > 1 && count.front() == '0') count.remove_prefix(1);
    for (const char c : count) {
      if (is_digit(c)) made_.frames = 10 * made_.frames + static_cast<std::uint64_t>(c - '0');
      if (!is_digit(c) || made_.frames > kMostFrames)
        return fail(position_, "number of frames", "Frames: and their number");
    }
    const std::size_t behind = at;
    const std::string_view time = declared(at, {"frame", "time", ":"});
    if (time.empty()) return fail(behind, "frame time", "Frame Time: and seconds");
    const auto seconds = stated_number(time, made_.seconds);
    if (!seconds) return fail(behind, "frame time", "seconds");
    made_.frame_time = *seconds;
    made_.rows_begin = at;
    done_ = true;
  }
};

}  // namespace

Hierarchy read_hierarchy(std::string_view text) { return Reader(text).read(); }

}  // namespace mocapress
