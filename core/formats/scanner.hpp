// A position in the rows of a motion file that moves by words, numbers and lines.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

#include "formats/text.hpp"
#include "numbers/text.hpp"

namespace mocapress {

struct Scanner {
  std::string_view text;
  std::size_t at = 0;

  bool ended() const { return at >= text.size(); }
  char next() const { return text[at]; }

  void skip_blanks() {
    while (at < text.size() && is_blank(text[at])) ++at;
  }
  // Passes lines that are empty, or begin with '#', from the beginning of a line on.
  void skip_empty_lines() {
    for (std::size_t ahead = at; ahead < text.size();) {
      while (ahead < text.size() && is_blank(text[ahead])) ++ahead;
      if (ahead < text.size() && text[ahead] == '#') ahead = end_of_line(text, ahead);
      if (ahead == text.size()) at = ahead;
      if (ahead == text.size() || !is_line_end(text[ahead])) return;
      at = ++ahead;
    }
  }
  // True at the end of a line, which it passes together with empty lines and comments behind it.
  bool line_end() {
    skip_blanks();
    if (ended()) return true;
    if (!is_line_end(next())) return false;
    ++at;
    skip_empty_lines();
    return true;
  }
  // The word that begins here, "" at the end of the line.
  std::string_view word() const {
    std::size_t end = at;
    while (end < text.size() && !is_space(text[end])) ++end;
    return text.substr(at, end - at);
  }
  // Passes a number that is a whole word.
  bool number(double& value, NumberShape& shape) {
    const char* const end = text.data() + text.size();
    const auto ends = [&](const char* rest) {
      return rest != nullptr && (rest == end || is_space(*rest));
    };
    const char* rest = parse_number(text.data() + at, end, value, shape);
    if (!ends(rest)) rest = parse_non_finite(text.data() + at, end, value, shape);
    if (!ends(rest)) return false;
    at = static_cast<std::size_t>(rest - text.data());
    return true;
  }
  // Passes a line that holds a whole number and nothing else, as those before an AMC's frames.
  bool counter(std::int64_t& value) {
    std::size_t ahead = at;
    while (ahead < text.size() && (text[ahead] == ' ' || text[ahead] == '\t')) ++ahead;
    const char* const begin = text.data() + ahead;
    const auto [rest, error] = std::from_chars(begin, text.data() + text.size(), value);
    if (error != std::errc{}) return false;
    Scanner behind{text, static_cast<std::size_t>(rest - text.data())};
    if (!behind.line_end()) return false;
    at = behind.at;
    return true;
  }
};

}  // namespace mocapress
