#include "exact/restoring.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "coding/fail.hpp"

namespace mocapress::exact {
namespace {

constexpr std::int64_t kFarthest = std::int64_t{1} << 52;
constexpr std::int64_t kFloats = std::int64_t{1} << 31;
constexpr double kMostFloat = std::numeric_limits<float>::max();
constexpr std::uint64_t kMostStep = std::uint64_t{1} << 33;

// The float32 at a place among all of them.
float float_at(std::int64_t place) {
  const auto inside = std::clamp(place, -kFloats, kFloats - 1);
  return std::bit_cast<float>(
      static_cast<std::uint32_t>(inside >= 0 ? inside : -1 - inside - kFloats));
}

std::int64_t place_of(float number) {
  const std::int64_t bits = std::bit_cast<std::int32_t>(number);
  return bits >= 0 ? bits : -1 - (bits + kFloats);
}

// The double of a float32 that is told by its bits; of NaN all bits count, which no conversion
// keeps on every machine.
double double_of(std::uint32_t bits) {
  const auto number = std::bit_cast<float>(bits);
  if (!std::isnan(number)) return number;
  const std::uint64_t wide = std::uint64_t{bits >> 31} << 63 | std::uint64_t{0x7FF8} << 48 |
                             std::uint64_t{bits & 0x7FFFFF} << 29;
  return std::bit_cast<double>(wide);
}

std::vector<std::int64_t> read_ascending(Record& record) {
  std::vector<std::int64_t> numbers(record.integer(record.left()));
  std::int64_t last = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    last = i == 0 ? record.signed_integer()
                  : last + 1 + static_cast<std::int64_t>(record.integer(kMostStep));
    if (last <= -kFarthest || last >= kFarthest) fail("a place beyond all numbers");
    numbers[i] = last;
  }
  return numbers;
}

Table read_table(Record& record) {
  Table table;
  const std::uint64_t kind = record.integer(2);
  table.all = kind == 2;
  if (table.all) return table;
  if (kind == 1) {
    table.places = read_ascending(record);
    if (table.places.empty() || table.places.front() < -kFloats || table.places.back() >= kFloats) {
      fail("a list without numbers, or of such as are no floats");
    }
    return table;
  }
  table.origin = record.number();
  table.step = record.number();
  if (!std::isfinite(table.origin) || !(table.step > 0) || !std::isfinite(table.step)) {
    fail("a grid without a step");
  }
  table.places = read_ascending(record);
  for (std::size_t i = 0; i < table.places.size(); ++i) {
    table.away.push_back(record.signed_integer());
    const std::int64_t away = table.away.back();
    if (away >= 2 * kFloats || away <= -2 * kFloats) {
      fail("a number too far from its grid");
    }
  }
  return table;
}

}  // namespace

double Table::number(double place) const {
  if (place != place)
    return double_of(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(place)));
  if (all) return static_cast<float>(std::clamp(place, -kMostFloat, kMostFloat));
  if (step == 0) {
    if (!(place >= 0 && place < static_cast<double>(places.size())) || place != std::floor(place)) {
      fail("a place outside its list");
    }
    return float_at(places[static_cast<std::size_t>(place)]);
  }
  const double exact = origin + step * place;
  float number = static_cast<float>(exact);
  const auto found = std::ranges::lower_bound(
      places, place, {}, [](std::int64_t listed) { return static_cast<double>(listed); });
  if (found != places.end() && static_cast<double>(*found) == place) {
    number = float_at(place_of(number) + away[static_cast<std::size_t>(found - places.begin())]);
  }
  return double_of(std::bit_cast<std::uint32_t>(number));
}

void Restoring::read(Record& header, std::size_t columns) {
  if (header.left() == 0) return;
  values_.resize(header.integer(header.left() / sizeof(double)));
  for (double& value : values_) value = header.number();
  if (!values_.empty()) {
    first_ = header.palette(columns, values_.size());
    second_ = header.palette(columns, values_.size());
  }
  const std::uint64_t count = header.integer(header.left());
  for (std::uint64_t i = 0; i < count; ++i) tables_.push_back(read_table(header));
  if (count > 0) table_of_ = header.palette(columns, count);
}

ByteView Restoring::take(ByteView payload, std::size_t frames, std::vector<Rows>& masks) const {
  Record record(payload);
  for (std::size_t mask = 0; mask < values_.size(); ++mask) {
    Rows rows;
    std::size_t row = 0;
    const std::size_t runs = record.integer(std::min(frames, record.left()));
    for (std::size_t run = 0; run < runs; ++run) {
      row += record.integer(frames);
      if (row >= frames) fail("gaps beyond the last row");
      if (run % 2 == 0) {
        rows.emplace_back(row, frames);
      } else {
        rows.back().second = row;
      }
    }
    masks.push_back(std::move(rows));
  }
  return record.raw(record.left());
}

void Restoring::restore(double* values, std::size_t frames, std::size_t columns,
                        const std::vector<Rows>& masks) const {
  for (std::size_t c = 0; c < columns; ++c) {
    if (!tables_.empty() && table_of_[c] > 0) {
      const Table& table = tables_[table_of_[c] - 1];
      for (std::size_t f = 0; f < frames; ++f) {
        double& value = values[f * columns + c];
        value = table.number(value);
      }
    }
    if (masks.empty()) continue;
    for (const auto number : {second_[c], first_[c]}) {
      if (number == 0) continue;
      for (const auto& [from, to] : masks[number - 1]) {
        for (std::size_t f = from; f < std::min(to, frames); ++f) {
          values[f * columns + c] = values_[number - 1];
        }
      }
    }
  }
}

}  // namespace mocapress::exact
