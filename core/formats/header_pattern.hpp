// What stands before the rows of a file, as a pattern that leaves to the skeleton what it says
// anyway: docs/format/layout.md, section "Patterns".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "numbers/text.hpp"

namespace mocapress {

// What a header may refer to. What cannot be printed is nothing.
struct HeaderReferences {
  std::vector<std::optional<std::string>> names;     // of the joints, in the file's encoding
  std::vector<std::optional<std::string>> channels;  // of each joint their number and words
  std::vector<double> numbers;                       // of each joint the offset and the end sites
  std::string time;                                  // the frame time, where there is one
  std::uint64_t rows = 0;
};

struct HeaderStyle {
  std::string line_break = "\n";
  std::string indentation;
  std::vector<NumberFormat> formats;  // of the numbers, at most 16
};

// The shortest pattern that prints the header, and the formats that it needs.
std::pair<std::string, std::vector<NumberFormat>> header_pattern(std::string_view header,
                                                                 const HeaderReferences& refer,
                                                                 const HeaderStyle& style);

// The header of a pattern; nothing, and why, where it refers to what there is not or becomes longer
// than `most` bytes.
std::optional<std::string> print_header(std::string_view pattern, const HeaderReferences& refer,
                                        const HeaderStyle& style, std::uint64_t most,
                                        const char*& why);

}  // namespace mocapress
