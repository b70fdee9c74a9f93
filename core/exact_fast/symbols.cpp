#include "exact_fast/symbols.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace mocapress::exact {
namespace {

constexpr int kQuarter = kOctave / 4;
constexpr int kFirstClass = -12;  // quarters of an octave
constexpr int kShifted = 12;      // from here on the last four classes repeat
constexpr int kMostShift = 50;
constexpr unsigned kPlain = 16;  // buckets of one distance each
constexpr unsigned kFar = 30;    // the bucket of all that is further than the others
constexpr std::uint64_t kFarthest = 2048;

// The first distance of a bucket, and the bits that follow for the rest.
struct Bucket {
  std::uint64_t from;
  int bits;
};

constexpr Bucket bucket(unsigned index) {
  if (index < kPlain) return {index, 0};
  if (index >= kFar) return {kFarthest, 0};
  const unsigned half = index - kPlain;  // of octaves
  return {std::uint64_t{2 + half % 2} << (3 + half / 2), static_cast<int>(3 + half / 2)};
}

unsigned bucket_of(std::uint64_t distance) {
  if (distance < kPlain) return static_cast<unsigned>(distance);
  if (distance >= kFarthest) return kFar;
  const auto octave = static_cast<unsigned>(std::bit_width(distance)) - 5;
  return kPlain + 2 * octave + static_cast<unsigned>(distance >> (octave + 3) & 1);
}

// The cumulative distribution of Student's t with four degrees of freedom.
double cumulative(double x) {
  const double u = 0.5 * x / std::sqrt(1 + 0.25 * x * x);
  return 0.5 + 0.75 * u * (1 - u * u / 3);
}

// Symbols in the order 0, -1, 1, -2, 2 ...: bucket n up is 2n, bucket n down is 2n + 1. Distances
// are whole, so that bucket n up begins half a step below its first distance, and bucket 0 down
// begins half a step below 0.
struct Table {
  std::array<std::uint16_t, Distances::kSymbols> start;
  std::array<std::uint16_t, Distances::kSymbols> size;
  std::array<std::uint8_t, 1024> symbol;  // the first in each 64th of 2^16
};

double share(double scale, unsigned symbol) {
  const Bucket own = bucket(symbol / 2);
  if (symbol >= 2 * kFar) return 0;
  const double half = symbol % 2 == 0 ? -0.5 : 0.5;
  const double from = static_cast<double>(own.from) + half;
  const double to = from + static_cast<double>(std::uint64_t{1} << own.bits);
  return cumulative(-from / scale) - cumulative(-to / scale);
}

Table make_table(int index) {
  Table table{};
  // 2^(quarters / 4) by square roots
  const double quarter = std::sqrt(std::sqrt(2.0));
  double scale = 1.0 / 8;
  for (int i = 0; i < index; ++i) scale *= quarter;
  constexpr std::uint32_t kLeast = 2;
  constexpr double kRest = 65536.0 - kLeast * Distances::kSymbols;
  std::uint32_t used = 0;
  for (unsigned symbol = 1; symbol < Distances::kSymbols; ++symbol) {
    const auto size = kLeast + static_cast<std::uint32_t>(kRest * share(scale, symbol));
    table.size[symbol] = static_cast<std::uint16_t>(size);
    used += size;
  }
  table.size[0] = static_cast<std::uint16_t>(65536 - used);
  std::uint32_t start = 0;
  for (unsigned symbol = 0; symbol < Distances::kSymbols; ++symbol) {
    table.start[symbol] = static_cast<std::uint16_t>(start);
    const std::uint32_t end = start + table.size[symbol];
    for (std::uint32_t cell = (start + 63) / 64; cell * 64 < end; ++cell) {
      table.symbol[cell] = static_cast<std::uint8_t>(symbol);
    }
    start = end;
  }
  return table;
}

std::array<Table, Distances::kClasses> make_tables() {
  std::array<Table, Distances::kClasses> tables;
  for (int i = 0; i < Distances::kClasses; ++i) tables[static_cast<std::size_t>(i)] = make_table(i);
  return tables;
}

const std::array<Table, Distances::kClasses> kTables = make_tables();

unsigned read(RansReading& side, const Table& table) {
  const std::uint32_t at = side.peek();
  unsigned symbol = table.symbol[at >> 6];
  while (symbol + 1 < Distances::kSymbols && at >= table.start[symbol + 1]) ++symbol;
  side.take({table.start[symbol], table.size[symbol]});
  return symbol;
}

}  // namespace

template <class Side>
std::int64_t Distances::code(Side& side, int scale, std::int64_t distance, bool& on_line) {
  const int quarters = std::clamp((scale + kQuarter / 2) >> 6, kFirstClass, 4 * kMostShift);
  const int shift = quarters >= kShifted ? (quarters - kShifted) / 4 + 1 : 0;
  const Table& table = kTables[static_cast<std::size_t>(quarters - 4 * shift - kFirstClass)];

  unsigned symbol = kOffLine;
  std::uint64_t away = 0;
  if constexpr (Side::kReading) {
    symbol = read(side, table);
  } else {
    const bool down = distance < 0;
    if (on_line) {
      away = down ? ~static_cast<std::uint64_t>(distance) : static_cast<std::uint64_t>(distance);
      symbol = 2 * bucket_of(away >> shift) + (down ? 1 : 0);
    }
    side.put({table.start[symbol], table.size[symbol]});
  }
  if (symbol < 2 * kFar) {
    const Bucket own = bucket(symbol / 2);
    const int bits = own.bits + shift;
    away = (own.from << shift) + side.raw(bits, away - (own.from << shift));
  } else if (symbol < 2 * kFar + 2) {
    const auto length = static_cast<std::uint32_t>(std::bit_width(away));
    const auto coded = static_cast<int>(side.uniform(64, length % 64));
    away = side.raw(coded, away);
  } else {
    on_line = false;
    return 0;
  }
  return static_cast<std::int64_t>(symbol % 2 == 0 ? away : ~away);
}

template std::int64_t Distances::code(RansWriting&, int, std::int64_t, bool&);
template std::int64_t Distances::code(RansReading&, int, std::int64_t, bool&);

}  // namespace mocapress::exact
