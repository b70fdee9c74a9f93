// AMC: the motion of an Acclaim skeleton, one line per bone and frame.
#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "formats/motion_file.hpp"
#include "formats/scanner.hpp"
#include "formats/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kMostLaterBones = 256;

bool is_padding_byte(char c) { return c == '\0' || c == '\x1a'; }

struct AmcBone {
  std::string_view word;  // as the file has it
  std::uint32_t count = 0;
  std::uint32_t first = 0;  // column
};

// The bones of all frames, and where each is found.
struct Bones {
  std::vector<AmcBone> list;
  std::unordered_map<std::string_view, std::size_t> places;
  bool repeated = false;  // two of one name: each frame has all of them in this order
  std::size_t columns = 0;

  explicit Bones(std::vector<AmcBone> bones) : list(std::move(bones)) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      list[i].first = static_cast<std::uint32_t>(columns);
      columns += list[i].count;
      repeated |= !places.emplace(list[i].word, i).second;
    }
  }
};

// Passes the words of a line; false where it is a counter, or nothing more follows.
bool bone_line(Scanner& scanner, AmcBone& bone) {
  scanner.skip_blanks();
  std::int64_t counter = 0;
  if (scanner.ended() || is_padding_byte(scanner.next()) || Scanner(scanner).counter(counter))
    return false;
  bone = {scanner.word()};
  scanner.at += bone.word.size();
  for (; !scanner.line_end(); ++bone.count) scanner.at += scanner.word().size();
  return true;
}

// The offset of the next line that holds a frame's number, from the beginning of a line on.
std::size_t next_counter(std::string_view text, std::size_t begin) {
  std::int64_t counter = 0;
  for (; begin < text.size(); begin = next_line(text, begin))
    if (Scanner{text, begin}.counter(counter)) break;
  return begin;
}

Scanner behind_counter(std::string_view text, std::size_t begin) {
  Scanner scanner{text, begin};
  std::int64_t counter = 0;
  scanner.counter(counter);
  return scanner;
}

std::vector<AmcBone> first_bones(std::string_view text, std::size_t begin) {
  std::vector<AmcBone> bones;
  AmcBone bone;
  for (Scanner scanner = behind_counter(text, begin); bone_line(scanner, bone);)
    bones.push_back(bone);
  return bones;
}

// All bones that any frame has, each behind the one that it follows there.
std::vector<AmcBone> all_bones(std::string_view text, std::size_t begin, const Bones& first) {
  // Of each bone that is new, what it stands behind; then those lists are put in.
  std::unordered_map<std::string_view, std::vector<AmcBone>> behind;
  std::unordered_map<std::string_view, bool> known;
  for (const AmcBone& bone : first.list) known.emplace(bone.word, true);
  std::string_view before;
  AmcBone bone;
  for (Scanner scanner{text, begin}; !scanner.ended();) {
    scanner.skip_empty_lines();
    if (!bone_line(scanner, bone)) {
      before = {};
      if (!scanner.ended()) scanner.at = next_line(text, scanner.at);
      continue;
    }
    if (bone.count > 0 && known.size() < first.list.size() + kMostLaterBones &&
        known.emplace(bone.word, true).second)
      behind[before].push_back(bone);
    before = known.contains(bone.word) ? bone.word : std::string_view();
  }
  std::vector<AmcBone> bones;
  std::vector<AmcBone> pending(first.list.rbegin(), first.list.rend());
  const auto put = [&](std::string_view word) {
    const auto found = behind.find(word);
    if (found == behind.end()) return;
    // Of several behind the same bone, the one that was seen last comes first.
    pending.insert(pending.end(), found->second.begin(), found->second.end());
    behind.erase(found);
  };
  put({});
  while (!pending.empty()) {
    bones.push_back(pending.back());
    pending.pop_back();
    put(bones.back().word);
  }
  return bones;
}

class Frames {
 public:
  Frames(std::string_view text, const Bones& bones)
      : text_(text), bones_(bones), row_(bones.columns), seen_(bones.list.size()) {}

  Reading read(std::size_t begin, Body& body) {
    return read_all(
        text_, begin, true, body, row_, [&](std::size_t at) { return frame(at, body); },
        [&](std::size_t at) { return next_counter(text_, next_line(text_, at)); });
  }

 private:
  std::string_view text_;
  const Bones& bones_;
  Row row_;
  std::vector<std::size_t> seen_;  // in which frame each bone was seen last
  std::size_t frame_ = 0;

  // A bone that the frame leaves out keeps its values of the frame before.
  RowStop frame(std::size_t begin, const Body& body) {
    Scanner scanner{text_, begin};
    scanner.skip_blanks();
    if (scanner.ended()) return {RowEnd::end_of_data, begin, begin};
    if (!scanner.counter(row_.counter)) return stop(RowEnd::number_expected, scanner.at, 0);
    ++frame_;
    std::size_t next = 0;
    std::size_t found = 0;
    std::int64_t other = 0;
    while (true) {
      scanner.skip_blanks();
      if (scanner.ended() || is_padding_byte(scanner.next())) break;
      const std::size_t at = scanner.at;
      if (next < bones_.list.size() && scanner.word() == bones_.list[next].word) {
        // The bone that comes next, as nearly always.
      } else if ((is_digit(scanner.next()) || scanner.next() == '-') &&
                 Scanner(scanner).counter(other)) {
        break;
      } else {
        const auto place = bones_.places.find(scanner.word());
        if (place == bones_.places.end() || bones_.repeated) {
          const bool more = next < bones_.list.size();
          return stop(more ? RowEnd::word_differs : RowEnd::counter_expected, at, next);
        }
        next = place->second;
      }
      if (seen_[next] == frame_) return stop(RowEnd::word_differs, at, next);
      seen_[next] = frame_;
      ++found;
      const RowEnd end = values(scanner, bones_.list[next]);
      if (end != RowEnd::whole) return stop(end, scanner.at, next);
      ++next;
    }
    if (bones_.repeated && next < bones_.list.size())
      return stop(RowEnd::word_differs, scanner.at, next);
    hold(body, found);
    return {RowEnd::whole, begin, scanner.at};
  }

  RowEnd values(Scanner& scanner, const AmcBone& bone) {
    scanner.at += bone.word.size();
    for (std::size_t c = bone.first; c < bone.first + bone.count; ++c) {
      scanner.skip_blanks();
      if (!scanner.number(row_.values[c], row_.shapes[c])) return RowEnd::number_expected;
    }
    return scanner.line_end() ? RowEnd::whole : RowEnd::line_end_expected;
  }

  // Fills in what the frame has not; a bone that was never seen before stands at 0.
  void hold(const Body& body, std::size_t found) {
    row_.given.clear();
    if (found == bones_.list.size()) return;
    row_.given.assign(bones_.columns, true);
    const double* const before =
        body.values.empty() ? nullptr : body.values.data() + body.values.size() - bones_.columns;
    for (std::size_t i = 0; i < bones_.list.size(); ++i) {
      if (seen_[i] == frame_) continue;
      const AmcBone& bone = bones_.list[i];
      for (std::size_t c = bone.first; c < bone.first + bone.count; ++c) {
        row_.given[c] = false;
        row_.values[c] = before == nullptr ? 0 : before[c];
      }
    }
  }

  static RowStop stop(RowEnd end, std::size_t at, std::size_t item) {
    return {end, 0, at, static_cast<std::uint32_t>(item)};
  }
};

std::string expected(const RowStop& stop, const Bones& bones) {
  if (stop.end == RowEnd::counter_expected || stop.item >= bones.list.size())
    return "the next frame's number, or the end of the file";
  const AmcBone& bone = bones.list[stop.item];
  const std::string name = shown(decoded_name(bone.word));
  if (stop.end == RowEnd::word_differs) return "bone " + name;
  return std::to_string(bone.count) + " numbers for bone " + name;
}

// The value of a header's line that begins with a word, or whether there is one.
std::optional<std::string_view> header_line(std::string_view header, std::string_view word) {
  for (std::size_t at = 0; at < header.size(); at = next_line(header, at)) {
    Scanner scanner{header, at};
    scanner.skip_blanks();
    if (!same_word(header.substr(scanner.at, word.size()), word)) continue;
    scanner.at += word.size();
    const std::size_t end = scanner.at;
    scanner.skip_blanks();
    const std::string_view value = scanner.word();
    if (scanner.at > end || value.empty()) return value;
  }
  return {};
}

void take_header(std::string_view header, const Skeleton* skeleton, MotionFile& made,
                 bool& radians) {
  if (header_line(header, ":radians")) {
    radians = true;
  } else if (header_line(header, ":degrees")) {
    radians = false;
  } else {
    radians = skeleton != nullptr && skeleton->radians;
  }
  const auto told = header_line(header, ":samples-per-second");
  double rate = 0;
  const auto stated = told ? stated_number(*told, rate) : std::nullopt;
  if (!stated || rate == 0) return;
  made.frame_time = *stated;
  made.is_rate = true;
  made.seconds = 1 / rate;
}

}  // namespace

MotionFile read_amc(std::string_view text, const Skeleton* skeleton) {
  MotionFile made;
  const std::size_t begin = next_counter(text, 0);
  if (begin == text.size()) {
    made.fault = Problem{.what = "no frame", .expected = "a line with a frame's number"};
    return made;
  }
  Bones bones(first_bones(text, begin));
  if (bones.columns == 0) {
    made.fault = Problem{.what = "the first frame cannot be read",
                         .expected = "lines with a bone and its numbers",
                         .line = line_of(text, begin)};
    return made;
  }
  made.body = Body(bones.columns, text.size());
  Reading reading = Frames(text, bones).read(begin, made.body);
  const auto first_stop = [&] {
    return !reading.stops.empty()    ? &reading.stops.front()
           : reading.waiting.empty() ? nullptr
                                     : &reading.waiting.front();
  };
  if (const RowStop* stop = first_stop();
      stop != nullptr && stop->end != RowEnd::number_expected && !bones.repeated) {
    const std::string_view word = Scanner{text, static_cast<std::size_t>(stop->next)}.word();
    if (!word.empty() && !is_padding_byte(word.front()) && !bones.places.contains(word)) {
      bones = Bones(all_bones(text, begin, bones));
      made.body = Body(bones.columns, text.size());
      reading = Frames(text, bones).read(begin, made.body);
    }
  }
  if (reading.too_many) {
    made.fault = too_many(made.body);
    return made;
  }
  const bool cut = !reading.waiting.empty() && !is_padding(text.substr(made.body.offsets.back()));
  if (!reading.stops.empty() || cut) {
    std::string wanted = expected(*first_stop(), bones);
    made.problems.push_back(unreadable(text, made.body, reading, std::move(wanted), cut));
  }
  if (made.body.rows() == 0) {
    made.fault = cut ? made.problems.front() : Problem{.what = "no frame"};
    return made;
  }
  if (!reading.waiting.empty() && !cut) made.problems.push_back(bytes_after_end(text, made.body));
  bool radians = false;
  take_header(text.substr(0, made.body.offsets.front()), skeleton, made, radians);
  for (const AmcBone& bone : bones.list) {
    const bool root = skeleton != nullptr && same_word(bone.word, "root");
    made.bones.push_back(
        {root ? skeleton->joints.front().name : decoded_name(bone.word), bone.count});
    made.words.emplace_back(bone.word);
  }
  made.fault = bone_columns(skeleton, made.bones, radians, made.columns);
  if (made.fault) return made;
  if (auto problem = not_numbers(text, made.body, made.columns))
    made.problems.push_back(std::move(*problem));
  return made;
}

std::vector<Slot> amc_slots(std::string_view row, const std::vector<std::string>& words,
                            const std::vector<std::uint32_t>& counts) {
  std::vector<AmcBone> list;
  list.reserve(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) list.push_back({words[i], counts[i]});
  const Bones bones(std::move(list));
  std::vector<Slot> slots;
  Scanner scanner{row, 0};
  scanner.skip_empty_lines();
  const auto pass = [&](std::int64_t column) {
    const std::size_t length = scanner.word().size();
    slots.push_back({static_cast<std::int32_t>(column), static_cast<std::uint32_t>(scanner.at),
                     static_cast<std::uint32_t>(scanner.at + length)});
    scanner.at += length;
  };
  scanner.skip_blanks();
  pass(-1);
  scanner.line_end();
  std::size_t next = 0;
  while (true) {
    scanner.skip_blanks();
    if (scanner.ended() || is_padding_byte(scanner.next())) return slots;
    const std::string_view word = scanner.word();
    if (next >= bones.list.size() || bones.list[next].word != word) {
      const auto place = bones.places.find(word);
      if (place == bones.places.end()) return slots;
      next = place->second;
    }
    scanner.at += word.size();
    for (std::int64_t column = bones.list[next++].first; !scanner.line_end(); ++column)
      pass(column);
  }
}

}  // namespace mocapress
