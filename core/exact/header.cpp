#include "exact/header.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>

#include "coding/fail.hpp"
#include "coding/record.hpp"
#include "exact/joint.hpp"
#include "exact/law.hpp"
#include "exact/tables.hpp"

namespace mocapress::exact {
namespace {

constexpr std::uint64_t kModel = 1, kOwnCouplings = 2, kLower = 4, kSkeleton = 8, kAsked = 16;
enum Role : std::uint8_t { kPredicted, kConstant, kCopy, kNoise, kRoles };
constexpr int kTurns = 3, kLines = 7, kLineDigits = 32, kExponentStep = 8, kMostExponent = 1000;
constexpr std::size_t kMostPlaces = 1 << 16, kMostTouching = 12;
constexpr std::uint64_t kMostSources = 6, kMostTargets = 3;
constexpr std::uint64_t kJointShapes = 243, kJointOnes = 9, kJointNumbers = 5, kJointBits = 11;
constexpr std::uint64_t kKinds = 8, kMostLevel = 9, kMostAbove = kMostLevel - kUsualLevel;
constexpr std::size_t kNowhere = ~std::size_t{0};

using Places = std::vector<std::size_t>;  // of columns; targets in the order of coding

struct Shape {
  int kind;
  std::size_t sources;
  Places columns;  // sources, targets
  std::vector<double> parameters;

  std::span<const std::size_t> targets() const { return std::span(columns).subspan(sources); }
  // The columns that are coded in this order, at the places that they have together.
  std::span<const std::size_t> ordered() const {
    const std::span all(columns);
    if (kind == 0) return {};
    if (kind == Joint::kKind) return all;
    return all.subspan(kind >= static_cast<int>(LawKind::spine_middle) ? 3 : sources);
  }
};

// Of the laws where all joints stand one behind the other, by kind.
Shape law_shape(int kind) {
  switch (static_cast<LawKind>(kind)) {
    case LawKind::spine:
    case LawKind::neck:
      return {kind, 6, {0, 1, 2, 3, 4, 5, 7, 6, 8}, {}};
    case LawKind::spine_middle:
    case LawKind::neck_middle:
      return {kind, 5, {0, 1, 2, 3, 5, 4}, {}};
    default:
      return {kind, 2, {0, 1, 2, 3}, {}};
  }
}

// Those of the known skeleton.
std::vector<Shape> own_couplings() {
  return {{1, 6, {6, 7, 8, 9, 10, 11, 13, 12, 14}, {}},
          {6, 5, {6, 7, 8, 9, 11, 10}, {}},
          {2, 6, {15, 16, 17, 18, 19, 20, 22, 21, 23}, {}},
          {7, 5, {15, 16, 17, 18, 20, 19}, {}},
          {4, 2, {31, 32, 34, 35}, {}},
          {3, 2, {43, 44, 46, 47}, {}}};
}

// A joint's shape and parameters; its columns, counted from the first of the joint.
Shape read_joint(Record& record) {
  constexpr std::uint64_t kMost = 2 * kJointOnes * kJointShapes * kJointBits << kJointNumbers;
  std::uint64_t told = record.integer(kMost - 1);
  const std::uint64_t given = told % (1 << kJointNumbers);
  told >>= kJointNumbers;
  const int bits = static_cast<int>(told % kJointBits) * 4;
  told /= kJointBits;
  const std::size_t sources = told % 2 + 1;
  const std::uint64_t shape = told / 2 % kJointShapes, ones = told / 2 / kJointShapes;
  std::vector<double> parameters;
  for (std::uint64_t i = 0; i < kJointNumbers; ++i) {
    const std::int64_t multiple = (given >> i & 1) != 0 ? record.signed_integer() : 0;
    parameters.push_back(std::ldexp(static_cast<double>(multiple), -bits));
  }
  parameters.insert(parameters.begin() + static_cast<std::ptrdiff_t>(ones % 3), 1.0);
  parameters.insert(parameters.begin() + 3 + static_cast<std::ptrdiff_t>(ones / 3), 1.0);
  parameters.insert(parameters.begin(), static_cast<double>(shape));
  if (!Joint::exists(sources, parameters)) fail("a joint of impossible shape");
  const std::size_t source = shape / 27 / 3, target = shape / 27 % 3;
  Places columns{source};
  if (sources == 2) columns.push_back(3 - source - target);
  columns.push_back(target);
  return {Joint::kKind, sources, columns, parameters};
}

Shape read_coupling(Record& record) {
  const std::uint64_t code = record.integer(2 * kKinds - 1);
  const int kind = static_cast<int>(code / 2);
  Shape shape{kind, 0, {}, {}};
  if (kind == Joint::kKind) {
    shape = read_joint(record);
  } else if (kind != 0) {
    shape = law_shape(kind);
  } else {
    shape.sources = record.integer(kMostSources);
    const std::size_t targets = record.integer(kMostTargets);
    if (shape.sources == 0 || targets == 0) fail("a coupling of impossible shape");
    for (std::size_t i = 0; i < shape.sources + targets; ++i) shape.columns.push_back(i);
  }
  if (code % 2 != 0) {
    for (auto& column : shape.columns) column = record.integer(kMostPlaces * kTogether);
  } else {
    const std::size_t first = record.integer(kMostPlaces * kTogether);
    for (auto& column : shape.columns) column += first;
  }
  return shape;
}

std::vector<Shape> read_couplings(Record& record, bool own) {
  std::vector<Shape> couplings;
  if (own) {
    const auto known = own_couplings();
    const std::uint64_t used = record.integer((1u << known.size()) - 1);
    for (std::size_t i = 0; i < known.size(); ++i) {
      if ((used >> i & 1) != 0) couplings.push_back(known[i]);
    }
    return couplings;
  }
  const std::uint64_t count = record.integer(record.left() / 2);
  for (std::uint64_t i = 0; i < count; ++i) couplings.push_back(read_coupling(record));
  return couplings;
}

// Puts columns in the order that couplings ask for.
class Order {
 public:
  Order(std::size_t columns, const Places& predicted)
      : places_(columns, kNowhere), touching_(columns), targets_(2 * columns) {
    for (std::size_t i = 0; i < predicted.size(); ++i) places_[predicted[i]] = i;
  }

  std::size_t place(std::size_t column) const { return places_[column]; }

  // Whether the coupling can stand with those before it.
  bool add(const Shape& shape) {
    const auto& columns = shape.columns;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] >= places_.size() || places_[columns[i]] >= kMostPlaces ||
          places_[columns[i]] / kTogether != places_[columns[0]] / kTogether ||
          touching_[columns[i]].size() == kMostTouching ||
          std::ranges::find(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(i),
                            columns[i]) != columns.begin() + static_cast<std::ptrdiff_t>(i)) {
        return false;
      }
    }
    for (const auto target : shape.targets()) {
      if (targets_[2 * target + (shape.kind == 0)]) return false;
      targets_[2 * target + (shape.kind == 0)] = true;
    }
    const auto moved = shape.ordered();
    Places sorted;
    for (const auto column : moved) sorted.push_back(places_[column]);
    std::ranges::sort(sorted);
    for (std::size_t i = 0; i < moved.size(); ++i) places_[moved[i]] = sorted[i];
    for (const auto column : columns) touching_[column].push_back(&shape);
    for (const auto column : columns) {
      for (const Shape* other : touching_[column]) {
        if (!stands(*other)) return false;
      }
    }
    return true;
  }

 private:
  // Whether its columns are coded in its order, the sources before the targets.
  bool stands(const Shape& shape) const {
    const auto at = [this](std::size_t column) { return places_[column]; };
    if (!std::ranges::is_sorted(shape.ordered(), {}, at)) return false;
    std::size_t last = 0, first = kNowhere;
    for (std::size_t i = 0; i < shape.columns.size(); ++i) {
      const std::size_t place = places_[shape.columns[i]];
      if (i < shape.sources) {
        last = std::max(last, place);
      } else {
        first = std::min(first, place);
      }
    }
    return last < first;
  }

  Places places_;
  std::vector<std::vector<const Shape*>> touching_;
  std::vector<bool> targets_;
};

Coupling coupled(const Shape& shape, const Order& order) {
  Coupling made{shape.kind, {}, {}, shape.parameters};
  for (std::size_t i = 0; i < shape.columns.size(); ++i) {
    auto& side = i < shape.sources ? made.sources : made.targets;
    side.push_back(static_cast<std::uint16_t>(order.place(shape.columns[i])));
  }
  std::ranges::sort(made.targets);
  return made;
}

std::vector<float> read_floats(Record& record) {
  const ByteView bytes = record.bytes();
  if (bytes.size() % sizeof(float) != 0) fail("a list of numbers cut off");
  std::vector<float> numbers(bytes.size() / sizeof(float));
  std::ranges::copy(bytes, reinterpret_cast<std::uint8_t*>(numbers.data()));
  for (const float number : numbers) {
    if (!(std::fabs(number) <= 1e29f)) fail("a start of numbers that were not learned");
  }
  return numbers;
}

// The level that a clip is coded at, or 0 where that of the parameter is; which one was asked for
// is of no use here.
int read_level(Record& record, std::uint64_t flags) {
  const bool asked_for_more = flags >= kAsked;
  if ((flags & kLower) == 0) return asked_for_more ? kUsualLevel : 0;
  if (asked_for_more) fail("a level that is named twice");
  const auto level = static_cast<int>(record.integer(10 * kMostLevel + 9) % 10);
  return level == 0 ? kStrongest : level;
}

}  // namespace

Header read_header(ByteView header, std::size_t columns) {
  Record record(header);
  const std::uint64_t flags = record.integer(kMostAbove * kAsked + kAsked - 1);
  const int level = read_level(record, flags);
  const bool skeleton = (flags & kSkeleton) != 0, own = (flags & kOwnCouplings) != 0;
  if (skeleton ? columns != kSkeletonChannels : own) fail("channels of another skeleton");
  const auto roles = record.palette(columns, kTurns * kRoles - 1);
  Places by_role[kRoles];
  Places moving;
  for (std::size_t c = 0; c < columns; ++c) {
    by_role[roles[c] % kRoles].push_back(c);
    if (roles[c] % kRoles == kPredicted || roles[c] % kRoles == kNoise) moving.push_back(c);
  }
  std::vector<Column> all(columns, {Line::float64, 0, false, 0, 0, -1});
  const auto lines = record.palette(moving.size(), kLines * kLineDigits - 1);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const auto c = moving[i];
    const int line = static_cast<int>(lines[i]) / kLineDigits;
    const int digits = static_cast<int>(lines[i]) % kLineDigits;
    if (!line_exists(line, digits)) fail("a line of unknown kind");
    all[c] = {static_cast<Line>(line),
              digits,
              roles[c] % kRoles == kNoise,
              0,
              static_cast<int>(roles[c] / kRoles),
              skeleton ? static_cast<int>(c) : -1};
  }
  const auto& moved = by_role[kPredicted];
  const auto exponents = record.palette(moved.size(), 2 * kMostExponent / kExponentStep);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const int half = static_cast<int>(exponents[i] / 2);
    all[moved[i]].exponent = kExponentStep * (exponents[i] % 2 == 0 ? half : -half - 1);
  }
  Header made;
  const auto back = record.palette(by_role[kCopy].size(), columns);
  for (std::size_t i = 0; i < back.size(); ++i) {
    const auto c = by_role[kCopy][i];
    if (back[i] >= c || roles[c - 1 - back[i]] % kRoles == kCopy) {
      fail("a column copies one that is not there");
    }
    made.copies.emplace_back(c, c - 1 - back[i]);
  }
  const auto& still = by_role[kConstant];
  const std::size_t size = record.integer(std::min(still.size(), record.left()));
  const auto numbers = size > 0 ? record.numbers(size) : std::vector<double>{};
  const auto which = record.indices(still.size(), size);
  for (std::size_t i = 0; i < still.size(); ++i) {
    made.constants.emplace_back(still[i], numbers[which[i]]);
  }
  const auto couplings = read_couplings(record, own);
  made.beside.read(record, columns);
  record.end();

  Order order(columns, moved);
  for (const auto& coupling : couplings) {
    if (!order.add(coupling)) fail("couplings that cannot stand together");
  }
  made.coded = moved;
  std::ranges::sort(made.coded, {}, [&](std::size_t c) { return order.place(c); });
  std::ranges::copy(by_role[kNoise], std::back_inserter(made.coded));
  for (const auto c : made.coded) made.columns.push_back(all[c]);
  for (const auto& coupling : couplings) made.couplings.push_back(coupled(coupling, order));
  made.level = level;
  made.has_model = (flags & kModel) != 0;
  return made;
}

Start read_start(ByteView model, const Header& header) {
  Record record(model);
  Start start;
  if (record.integer(kMostLevel) == 0) fail("a level that there is not");  // at which it learned
  start.shared = read_floats(record);
  std::map<std::uint64_t, std::vector<float>> learned;
  const std::uint64_t count = record.integer(record.left() / 2);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t column = record.integer();
    learned[column] = read_floats(record);
  }
  record.end();
  for (const auto c : header.coded) start.columns.push_back(learned[c]);
  return start;
}

void decode(ByteView payload, double* values, std::size_t frames, std::size_t wanted,
            std::size_t columns, const Header& header, int level, const Start& start) {
  const std::size_t coded = header.coded.size();
  // A number costs at least log2(65536 / 65512) bits.
  if (coded * frames > (payload.size() + 64) << 14) fail("the chunk is cut off");
  std::vector<Restoring::Rows> masks;
  const ByteView own = header.beside.take(payload, frames, masks);
  const bool whole = wanted == frames || coded > kTogether;
  const std::size_t count = whole ? frames : wanted;
  std::vector<double> rows(count * coded);
  if (coded > 0 || !own.empty()) {
    const int used = header.level > 0 ? header.level : level;
    decode(own, rows.data(), count, Clip{header.columns, header.couplings, used, start}, whole);
  }
  for (std::size_t f = 0; f < wanted; ++f) {
    double* const row = values + f * columns;
    for (std::size_t i = 0; i < coded; ++i) row[header.coded[i]] = rows[f * coded + i];
    for (const auto& [c, number] : header.constants) row[c] = number;
    for (const auto& [c, original] : header.copies) row[c] = row[original];
  }
  header.beside.restore(values, wanted, columns, masks);
}

}  // namespace mocapress::exact
