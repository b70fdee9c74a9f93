// What is wrong with a file, as data: the same words in Python and in the page.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mocapress {

struct Problem {
  std::string what = {};
  std::string expected = {};  // empty: not said
  std::string found = {};
  std::uint64_t line = 0;      // counted from 1; 0: not said
  std::int64_t offset = -1;    // in bytes; -1: not said
  std::string_view name = {};  // of a departure from the format that can be read nevertheless
  bool loses_motion = false;   // whether frames that the file should hold are missing
};

inline constexpr std::string_view kMissingRows = "missing-rows";
inline constexpr std::string_view kUnreadableRows = "unreadable-rows";
inline constexpr std::string_view kExtraRows = "extra-rows";
inline constexpr std::string_view kBytesAfterEnd = "bytes-after-end";
inline constexpr std::string_view kNotNumbers = "not-numbers";
inline constexpr std::string_view kExtraNumbers = "extra-numbers";
inline constexpr std::string_view kScaleChannels = "scale-channels";

}  // namespace mocapress
