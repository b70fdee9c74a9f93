#include "formats/body.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "formats/text.hpp"

namespace mocapress {
namespace {

constexpr std::size_t kMostShown = 16;  // bytes in a message

// A frame number so many later; without end, around it goes.
std::int64_t moved(std::int64_t counter, std::uint64_t by) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(counter) + by);
}

}  // namespace

void note(ColumnStatistics& column, const NumberShape& shape) {
  if (shape.exponent_digits > 0) {
    column.exponent_digits = column.exponent_digits == 0
                                 ? shape.exponent_digits
                                 : std::min(column.exponent_digits, shape.exponent_digits);
  } else {
    column.least_decimals = std::min(column.least_decimals, shape.decimals);
    column.most_decimals = std::max(column.most_decimals, shape.decimals);
  }
  column.most_significant = std::max(column.most_significant, shape.significant);
  column.trailing_zero |= shape.trailing_zero;
  column.whole_without_point |= !shape.point;
  column.bare_point |= shape.bare_point;
  column.upper |= shape.upper;
  column.plus |= shape.plus;
  column.leading_zero |= shape.leading_zero;
  column.end_point |= shape.end_point;
}

void append_row(Body& body, const Row& row, std::uint64_t begin, bool counted) {
  body.values.insert(body.values.end(), row.values.begin(), row.values.end());
  body.offsets.push_back(begin);
  if (counted) body.counters.push_back(row.counter);
  for (std::size_t c = 0; c < body.columns; ++c) {
    if (!row.shapes[c].word && (row.given.empty() || row.given[c]))
      note(body.statistics[c], row.shapes[c]);
  }
}

void append_held(Body& body, const std::vector<RowStop>& waiting, const Row& after, bool counted) {
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    const std::size_t size = body.values.size();
    body.unread.push_back(static_cast<std::int64_t>(body.offsets.size()));
    body.offsets.push_back(waiting[k].begin);
    if (counted) {
      body.counters.push_back(body.counters.empty() ? moved(after.counter, 0 - waiting.size())
                                                    : moved(body.counters.back(), 1));
    }
    if (size == 0) {
      body.values = after.values;
    } else {
      body.values.resize(size + body.columns);
      std::copy_n(body.values.begin() + static_cast<std::ptrdiff_t>(size - body.columns),
                  body.columns, body.values.begin() + static_cast<std::ptrdiff_t>(size));
    }
  }
}

Problem too_many(const Body& body) {
  return {.what = "more frames and channels than a file of this size may have",
          .expected = "a product of at most " + std::to_string(most_values(body.text_size)),
          .found = std::to_string(body.offsets.size()) + " x " + std::to_string(body.columns)};
}

Problem unreadable(std::string_view text, const Body& body, const Reading& reading,
                   std::string expected, bool cut) {
  const std::size_t count = body.unread.size() + cut;
  const std::size_t first =
      body.unread.empty() ? body.rows() : static_cast<std::size_t>(body.unread.front());
  const RowStop& stop = reading.stops.empty() ? reading.waiting.front() : reading.stops.front();
  const std::size_t offset = std::min<std::size_t>(stop.next, text.size());
  const std::string frame = "frame " + std::to_string(first + 1);
  return {.what = count > 1
                      ? std::to_string(count) + " frames cannot be read, the first of them " + frame
                      : frame + " cannot be read",
          .expected = std::move(expected),
          .found = found_at(text, offset),
          .line = line_of(text, offset),
          .offset = static_cast<std::int64_t>(offset),
          .name = kUnreadableRows,
          .loses_motion = true};
}

Problem bytes_after_end(std::string_view text, const Body& body) {
  const std::string_view tail = text.substr(body.offsets.back());
  const std::string_view stripped = trimmed(tail);
  const std::string_view rest = stripped.empty() ? tail : stripped;
  const auto offset = static_cast<std::size_t>(rest.data() - text.data());
  return {.what = "bytes after the last frame",
          .expected = "the end of the file",
          .found = std::to_string(rest.size()) + " bytes that begin with " +
                   quoted(rest.substr(0, kMostShown)),
          .line = line_of(text, offset),
          .offset = static_cast<std::int64_t>(offset),
          .name = kBytesAfterEnd};
}

std::optional<Problem> not_numbers(std::string_view text, const Body& body,
                                   const std::vector<Column>& columns) {
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < body.values.size(); ++i)
    if (!std::isfinite(body.values[i]) && count++ == 0) first = i;
  if (count == 0) return {};
  const std::size_t row = first / body.columns;
  const std::size_t offset = body.offsets[row];
  return Problem{.what = std::to_string(count) +
                         (count == 1 ? " value is no number, in frame "
                                     : " values are no numbers, the first of them in frame ") +
                         std::to_string(row + 1),
                 .expected = "finite numbers",
                 .found = (std::isnan(body.values[first]) ? "nan in " : "infinity in ") +
                          shown(columns[first % body.columns].name),
                 .line = line_of(text, offset),
                 .offset = static_cast<std::int64_t>(offset),
                 .name = kNotNumbers};
}

}  // namespace mocapress
