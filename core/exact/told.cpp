#include "exact/told.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "coding/fail.hpp"
#include "numbers/line.hpp"

namespace mocapress::exact {
namespace {

constexpr std::int64_t kFarthest = std::int64_t{1} << 52;
constexpr std::int64_t kFloats = std::int64_t{1} << 31;  // of either sign
constexpr std::uint64_t kMostStep = std::uint64_t{1} << 33;

const NumberLine& floats() {
  static const NumberLine kLine(Line::float32, 0);
  return kLine;
}

double float_at(std::int64_t place) {
  return floats().number(std::clamp(place, -kFloats, kFloats - 1));
}

std::vector<std::int64_t> ascending(Record& record) {
  std::vector<std::int64_t> numbers(record.integer(record.left()));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = i == 0 ? record.signed_integer()
                        : numbers[i - 1] + 1 + static_cast<std::int64_t>(record.integer(kMostStep));
    if (numbers[i] <= -kFarthest || numbers[i] >= kFarthest) fail("a place beyond all numbers");
  }
  return numbers;
}

double read_double(Record& record) {
  const ByteView bytes = record.raw(sizeof(double));
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(double); ++i) bits |= std::uint64_t{bytes[i]} << (8 * i);
  return std::bit_cast<double>(bits);
}

Table read_table(Record& record) {
  Table table;
  if (record.integer(1) == 0) {
    table.origin = read_double(record);
    table.step = read_double(record);
    if (!std::isfinite(table.origin) || !std::isfinite(table.step) || !(table.step > 0)) {
      fail("a grid without a step");
    }
    table.places = ascending(record);
    for (std::size_t i = 0; i < table.places.size(); ++i) {
      table.away.push_back(record.signed_integer());
      if (std::abs(table.away.back()) >= 2 * kFloats) fail("a number too far from its grid");
    }
    return table;
  }
  const auto places = ascending(record);
  if (places.empty() || places.front() < -kFloats || places.back() >= kFloats) {
    fail("a list without numbers, or of such as are no floats");
  }
  for (const auto place : places) table.numbers.push_back(float_at(place));
  return table;
}

}  // namespace

double Table::number(double place) const {
  if (step == 0) {
    if (!(place >= 0) || !(place < static_cast<double>(numbers.size())) ||
        place != std::floor(place)) {
      fail("a place outside its list");
    }
    return numbers[static_cast<std::size_t>(place)];
  }
  const double exact = origin + step * place;
  const std::int64_t near = floats().near(exact);
  if (std::fabs(place) < static_cast<double>(kFarthest) && place == std::floor(place)) {
    const auto found = std::ranges::lower_bound(places, static_cast<std::int64_t>(place));
    if (found != places.end() && *found == static_cast<std::int64_t>(place)) {
      return float_at(near + away[static_cast<std::size_t>(found - places.begin())]);
    }
  }
  return floats().number(near);
}

std::vector<Runs> Told::runs(Record& payload, std::size_t frames) const {
  std::vector<Runs> found(values.size());
  for (auto& runs : found) {
    runs.resize(payload.integer(std::min(frames, payload.left())));
    std::size_t row = 0;
    for (auto& end : runs) {
      row += payload.integer(frames);
      if (row >= frames) fail("gaps beyond the last row");
      end = row;
    }
  }
  return found;
}

void Told::restore(double* numbers, std::size_t frames, std::size_t columns,
                   const std::vector<Runs>& runs) const {
  for (std::size_t c = 0; c < table.size(); ++c) {
    if (table[c] == 0) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      double& number = numbers[f * columns + c];
      if (number == number) {
        number = tables[table[c] - 1].number(number);
      } else {
        const auto low = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(number));
        number = std::bit_cast<float>(low);
      }
    }
  }
  for (std::size_t c = 0; c < masks.size(); ++c) {
    for (const std::size_t mask : {masks[c][1], masks[c][0]}) {
      if (mask == 0) continue;
      const Runs& ends = runs[mask - 1];
      for (std::size_t run = 0; run < ends.size(); run += 2) {
        const std::size_t end = run + 1 < ends.size() ? ends[run + 1] : frames;
        for (std::size_t f = ends[run]; f < end; ++f) numbers[f * columns + c] = values[mask - 1];
      }
    }
  }
}

Told read_told(Record& header, std::size_t columns) {
  Told told;
  if (header.left() == 0) return told;
  told.values.resize(header.integer(header.left() / sizeof(double)));
  for (auto& value : told.values) value = read_double(header);
  if (!told.values.empty()) {
    const auto first = header.palette(columns, told.values.size());
    const auto second = header.palette(columns, told.values.size());
    for (std::size_t c = 0; c < columns; ++c) told.masks.push_back({first[c], second[c]});
  }
  told.tables.resize(header.integer(header.left()));
  for (auto& table : told.tables) table = read_table(header);
  if (!told.tables.empty()) {
    for (const auto number : header.palette(columns, told.tables.size())) {
      told.table.push_back(number);
    }
  }
  return told;
}

}  // namespace mocapress::exact
