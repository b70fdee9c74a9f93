#include "diffma/stored.hpp"

#include <limits>
#include <span>
#include <vector>

#include "coding/fail.hpp"
#include "coding/record.hpp"
#include "diffma/codec.hpp"
#include "numbers/text.hpp"

namespace mocapress::diffma {
namespace {

// Takes what stands before the next `end`, or all that is left.
std::string_view taken(std::string_view& text, char end) {
  const std::size_t size = text.find(end);
  const std::string_view piece = text.substr(0, size);
  text = size == text.npos ? std::string_view{} : text.substr(size + 1);
  return piece;
}

double number_of(std::string_view text) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (text == "inf") return kInfinite;
  if (text == "-inf") return -kInfinite;
  double value;
  NumberShape shape;
  const std::span<const char> all(text);
  if (parse_number(all.data(), all.data() + all.size(), value, shape) != all.data() + all.size()) {
    fail("a table of what is no number");
  }
  return value;
}

}  // namespace

void decode_stored(ByteView header, std::string_view text, int bits, std::size_t window,
                   double* values, std::size_t frames, std::size_t columns) {
  std::vector<Parameters> plans;
  mocapress::Record record(header);
  while (plans.size() < columns) {
    const double bound = record.number();
    const int order = static_cast<int>(record.integer(kMostOrder));
    const std::size_t count = record.integer(columns - plans.size());
    if (!(bound > 0 && bound < std::numeric_limits<double>::infinity()) || count == 0) {
      fail("no bound above 0, or of no channels");
    }
    plans.insert(plans.end(), count, Parameters{bits, window, bound, order});
  }
  record.end();

  std::size_t lines = text.empty() && columns == 0 ? 0 : 1;
  for (const char c : text) lines += c == '\n';
  if (lines != 2 * columns) fail("another number of lines than the columns have");
  std::vector<std::string_view> opcodes(columns);
  for (auto& line : opcodes) line = taken(text, '\n');
  std::vector<double> channel(frames);
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<double> table;
    std::string_view line = taken(text, '\n');
    do {
      table.push_back(number_of(taken(line, ' ')));
    } while (!line.empty());
    decode(opcodes[c], table, plans[c], channel);
    for (std::size_t f = 0; f < frames; ++f) values[f * columns + c] = channel[f];
  }
}

}  // namespace mocapress::diffma
