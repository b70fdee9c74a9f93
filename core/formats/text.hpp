// Text of motion files: lines, words, names.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mocapress {

// Lines end in LF, CR LF, or CR.
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
inline bool is_space(char c) { return is_blank(c) || is_line_end(c); }

std::string_view trimmed(std::string_view text);
// The words between blanks.
std::vector<std::string_view> words_of(std::string_view text);
std::string lower(std::string_view text);  // ASCII
bool same_word(std::string_view text, std::string_view lower_case);

// The number of the line in which a byte stands, counted from 1.
std::uint64_t line_of(std::string_view text, std::size_t offset);
// Where the line ends that an offset lies in, and where the next begins.
std::size_t end_of_line(std::string_view text, std::size_t offset);
std::size_t next_line(std::string_view text, std::size_t offset);

// What programs leave behind the text: NULs, or the Ctrl-Z of DOS.
bool is_padding(std::string_view rest);

// The text of a file in UTF-16, which begins with a byte order mark, as UTF-8; what is no UTF-16
// and every other file gives nothing.
std::optional<std::string> from_utf16(std::string_view bytes);

// A text as a message shows it: control characters escaped, so that none reaches a terminal.
std::string shown(std::string_view text);
// The same in quotes.
std::string quoted(std::string_view text);
// The word at an offset as a message shows it, or that the line or the file ends there.
std::string found_at(std::string_view text, std::size_t offset);

// A joint's name from its bytes: `%20` is a blank, `%.2` nothing; UTF-8 where it is that, otherwise
// ISO 8859-1. The result is UTF-8, in which surrogates may stand alone.
std::string decoded_name(std::string_view raw);

// A number as a header states it: not negative, at most 100 digits, 1e-18 to 1e18, or 0. Gives it
// written without blanks, or nothing.
std::optional<std::string> stated_number(std::string_view text, double& value);

// The finite number that is the whole text.
std::optional<double> finite_number(std::string_view text);

}  // namespace mocapress
