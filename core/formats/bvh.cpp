// BVH: a skeleton and its motion in one file.
#include <algorithm>
#include <string>
#include <utility>

#include "formats/hierarchy.hpp"
#include "formats/motion_file.hpp"
#include "formats/rows.hpp"

namespace mocapress {
namespace {

// How many numbers, or other words, stand on each line with any.
std::vector<std::size_t> words_of_lines(std::string_view text, std::size_t begin,
                                        std::size_t most_lines) {
  std::vector<std::size_t> counts;
  Scanner scanner{text, begin};
  scanner.skip_empty_lines();
  const auto padding = [&] { return scanner.next() == '\0' || scanner.next() == '\x1a'; };
  while (!scanner.ended() && !padding() && counts.size() < most_lines) {
    std::size_t count = 0;
    while (!scanner.line_end() && !padding()) {
      scanner.at += scanner.word().size();
      ++count;
    }
    if (count > 0) counts.push_back(count);
  }
  return counts;
}

// Whether all lines have so many numbers, more than there are channels.
bool is_wide(const std::vector<std::size_t>& counts, std::uint64_t frames, std::size_t channels) {
  const std::size_t width = counts.front();
  return width > channels && (counts.size() == frames || width % channels != 0) &&
         std::all_of(counts.begin(), counts.end(), [&](std::size_t n) { return n == width; });
}

// Whether frames are no lines: all of them wrap alike, or there are several on a line, or all the
// numbers together are as many as declared. Finds, too, how many numbers a frame has where all have
// more of them than channels.
bool is_free(std::string_view text, const Hierarchy& hierarchy, std::size_t channels,
             std::size_t& width) {
  width = channels;
  const auto first = words_of_lines(text, hierarchy.rows_begin, 1);
  if (first.empty() || first.front() == channels) return false;
  const auto counts = words_of_lines(text, hierarchy.rows_begin, SIZE_MAX);
  if (is_wide(counts, hierarchy.frames, channels)) {
    width = first.front();
    return false;
  }
  if (first.front() % channels == 0) return true;
  std::size_t all = 0;
  for (const std::size_t count : counts) all += count;
  if (all % channels == 0 && all / channels == hierarchy.frames) return true;
  std::size_t lines = 0;
  for (std::size_t sum = 0; sum < channels && lines < counts.size(); ++lines) {
    sum += counts[lines];
    if (sum > channels) return false;
  }
  if (lines == counts.size()) return false;
  return hierarchy.frames < 2 ||
         (2 * lines <= counts.size() &&
          std::equal(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(lines),
                     counts.begin() + static_cast<std::ptrdiff_t>(lines)));
}

void find_problems(std::string_view text, const Reading& reading, std::uint64_t declared,
                   const std::string& expected_row, MotionFile& made) {
  const std::uint64_t found = made.body.rows();
  const std::string_view rest = trimmed(text.substr(made.body.offsets.back()));
  // Where as many frames as declared were read, what is no row is none that is missing.
  const bool more = found > declared && !rest.empty() &&
                    std::string_view("+-.0123456789").find(rest.front()) != std::string_view::npos;
  const bool cut = !rest.empty() && !is_padding(rest) && (found < declared || more);
  if (!reading.stops.empty() || cut)
    made.problems.push_back(unreadable(text, made.body, reading, expected_row, cut));
  if (found + cut < declared) {
    made.problems.push_back({.what = "frames are missing",
                             .expected = std::to_string(declared) + " frames, as declared",
                             .found = std::to_string(found),
                             .name = kMissingRows,
                             .loses_motion = true});
  }
  if (found > declared) {
    const std::uint64_t offset = made.body.offsets[declared];
    made.problems.push_back({.what = "more frames than declared",
                             .expected = std::to_string(declared) + " frames",
                             .found = std::to_string(found),
                             .line = line_of(text, offset),
                             .offset = static_cast<std::int64_t>(offset),
                             .name = kExtraRows});
  }
  if (!rest.empty() && !cut) made.problems.push_back(bytes_after_end(text, made.body));
}

}  // namespace

MotionFile read_bvh(std::string_view text) {
  MotionFile made;
  Hierarchy hierarchy = read_hierarchy(text);
  if (hierarchy.fault) {
    made.fault = std::move(hierarchy.fault);
    return made;
  }
  made.columns = skeleton_columns(hierarchy.skeleton);
  const std::size_t channels = made.columns.size();
  if (channels == 0) {
    made.fault = Problem{.what = "no channels", .expected = "a joint with CHANNELS"};
    return made;
  }
  made.frame_time = hierarchy.frame_time;
  made.seconds = hierarchy.seconds;
  std::size_t width = 0;
  made.free = is_free(text, hierarchy, channels, width);
  for (std::size_t k = channels; k < width; ++k) {
    const std::string kind = 'v' + std::to_string(k - channels + 1);
    made.columns.push_back({"extra." + kind, -1, kind, ""});
  }
  made.body = Body(width, text.size());
  Row row(width);
  const Reading reading = read_all(
      text, hierarchy.rows_begin, false, made.body, row,
      [&](std::size_t at) { return read_numbers(text, at, made.free, row); },
      [&](std::size_t at) { return made.free ? text.size() : next_line(text, at); });
  if (reading.too_many) {
    made.fault = too_many(made.body);
    return made;
  }
  find_problems(text, reading, hierarchy.frames,
                std::to_string(width) + (made.free ? " numbers" : " numbers on a line"), made);
  if (width > channels) {
    made.problems.push_back({.what = "rows have more numbers than there are channels",
                             .expected = std::to_string(channels),
                             .found = std::to_string(width),
                             .line = line_of(text, hierarchy.rows_begin),
                             .offset = static_cast<std::int64_t>(hierarchy.rows_begin),
                             .name = kExtraNumbers});
  }
  if (auto problem = not_numbers(text, made.body, made.columns))
    made.problems.push_back(std::move(*problem));
  for (std::size_t c = 0; c < channels; ++c) {
    if (made.columns[c].kind[0] != 's') continue;
    made.problems.push_back({.what = "channels that scale are kept, but scale nothing here",
                             .found = shown(made.columns[c].name),
                             .name = kScaleChannels});
    break;
  }
  made.skeleton = std::move(hierarchy.skeleton);
  return made;
}

std::vector<Slot> bvh_slots(std::string_view row, std::size_t columns) {
  std::vector<Slot> slots;
  Scanner scanner{row, 0};
  scanner.skip_empty_lines();
  while (slots.size() < columns && !scanner.ended()) {
    if (scanner.line_end()) continue;
    const std::size_t length = scanner.word().size();
    slots.push_back({static_cast<std::int32_t>(slots.size()),
                     static_cast<std::uint32_t>(scanner.at),
                     static_cast<std::uint32_t>(scanner.at + length)});
    scanner.at += length;
  }
  return slots;
}

}  // namespace mocapress
