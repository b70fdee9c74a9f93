#include "exact/residual.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "coding/sides.hpp"
#include "exact/tables.hpp"

namespace mocapress::exact {
namespace {

// Below this many steps of the line, the scale is too small for buckets.
constexpr double kFine = 3;
// The symbol of a length that says: the number is not on the line, and follows raw.
constexpr unsigned kOffLine = 63;
// Behind this many decades the chance of a smaller one is no longer what lengths tell.
constexpr int kPlainDecades = 5;

// The bounds of the buckets in scales: denser in the middle, out to +-12.
std::array<double, kBuckets - 1> make_bounds() {
  std::array<double, kBuckets - 1> bounds{};
  for (int i = 0; i < kBuckets - 1; ++i) {
    const double q = (i + 1) / (kBuckets / 2.0) - 1;
    const double square = q * q;
    bounds[static_cast<std::size_t>(i)] =
        q * (4.65 + square * (5.25 + square * (1.77 + 0.33 * square)));
  }
  return bounds;
}

const std::array<double, kBuckets - 1> kBounds = make_bounds();

template <class Nodes>
Nodes first_shape() {
  Nodes nodes;
  for (std::size_t node = 1; node < kBuckets; ++node) {
    nodes[node].of_one = std::uint32_t{kFirst.shape[node]} << 16;
  }
  return nodes;
}

// Places lie up to 2^64 apart, hence unsigned; what a damaged stream says may wrap around.
std::uint64_t distance(std::int64_t from, std::int64_t to) {
  const std::uint64_t up = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  return to >= from ? up : 0 - up;
}

std::int64_t moved(std::int64_t place, std::uint64_t by, bool down) {
  const auto from = static_cast<std::uint64_t>(place);
  return static_cast<std::int64_t>(down ? from - by : from + by);
}

// Which models code steps, by the scale in steps.
std::size_t octave(double scale) {
  const auto exponent = static_cast<int>(std::bit_cast<std::uint64_t>(scale) >> 52) - 1023;
  return static_cast<std::size_t>(
      std::clamp(exponent + Remainders::kOctaves - 2, 0, Remainders::kOctaves - 1));
}

// Coders that share the models of one residual.
template <class Side>
class Coding {
 public:
  Coding(Side& side, const NumberLine& line, Remainders& models)
      : side_(side), line_(line), models_(models) {}

  // A magnitude of at most 62 bits: its length by a tree, the rest raw. Length 63: not on the line.
  std::uint64_t magnitude(BitTree<6>& tree, std::uint64_t value, bool on_line) {
    const auto bits = static_cast<unsigned>(std::bit_width(value));
    const unsigned length = tree.code(side_, on_line && bits < kOffLine ? bits : kOffLine);
    off_line_ = length == kOffLine;
    if (off_line_) return 0;
    return code_below_leading(side_, static_cast<int>(length), value);
  }

  double finish(std::int64_t place, double number) {
    if (!off_line_) return Side::kReading ? line_.number(place) : number;
    return std::bit_cast<double>(side_.raw(64, std::bit_cast<std::uint64_t>(number)));
  }

  std::int64_t steps(double prediction, double scale_in_steps, std::int64_t place, bool on_line) {
    // The number next to the prediction, and where between it and the next the prediction lies.
    const std::int64_t near = line_.near(prediction);
    const double fraction = (line_.number(near) - prediction) / line_.step(prediction) + 0.5;
    const auto quarter = static_cast<std::size_t>(fraction > 0 ? std::min(fraction * 4, 3.0) : 0);
    auto& models = models_.steps[octave(scale_in_steps)];
    if (!side_.bit(models.none[quarter], !on_line || place != near)) return near;
    const bool negative = side_.bit(models.negative[quarter], place < near);
    const std::uint64_t size = distance(near, place) - 1;
    std::uint64_t coded = 0;
    while (coded < Remainders::kUnary && side_.bit(models.more[coded], !on_line || size > coded)) {
      ++coded;
    }
    if (coded == Remainders::kUnary) coded += magnitude(models_.far, size - coded, on_line);
    return moved(near, coded + 1, negative);
  }

  // One of the places from <= place < to.
  std::int64_t within(std::int64_t from, std::int64_t to, std::int64_t place) {
    if (!line_.significant()) return uniform(from, to, place);
    if (from < 0 && to > 0) {
      const bool negative = side_.bit(models_.negative, place < 0);
      (negative ? to : from) = 0;
    }
    return from >= 0 ? decades(from, to, place) : -1 - decades(-to, -from, -1 - place);
  }

 private:
  std::int64_t uniform(std::int64_t from, std::int64_t to, std::int64_t place) {
    return moved(from, code_uniform(side_, distance(from, to), distance(from, place)), false);
  }

  // Numbers of a lower decade lie ten times as dense, and so each is a tenth as likely: from the
  // highest decade down, whether the number lies in a smaller one.
  std::int64_t decades(std::int64_t from, std::int64_t to, std::int64_t place) {
    for (int depth = 0;; ++depth) {
      if (to - from <= 1) return uniform(from, to, place);
      const int decade = line_.decade_of(to - 1);
      const std::int64_t start = line_.decade(decade);
      if (from >= start) return uniform(from, to, place);
      bool smaller = place < start;
      if (depth < kPlainDecades) {
        const auto in_this = static_cast<double>(to - start);
        const auto in_smaller = static_cast<double>(line_.decade(1) - line_.decade(0)) / 9;
        const double share = in_this / (in_this + in_smaller);
        smaller = side_.chance(static_cast<std::uint32_t>(64 + share * 65408), smaller);
      } else {
        smaller =
            side_.bit(models_.smaller[static_cast<std::size_t>(decade - kLowestPower)], smaller);
      }
      (smaller ? to : from) = start;
    }
  }

  Side& side_;
  const NumberLine& line_;
  Remainders& models_;
  bool off_line_ = false;
};

}  // namespace

Shape::Shape(std::size_t channels)
    : fast(first_shape<Nodes<7>>()),
      slow(first_shape<Nodes<10>>()),
      own(channels, first_shape<Nodes<6>>()) {}

void Residual::share_shape() {
  for (auto& own : shape_.own) {
    for (std::size_t i = 0; i < own.size(); ++i) own[i].of_one = shape_.slow[i].of_one;
  }
}

template <class Side>
double Residual::code(Side& side, std::size_t channel, const NumberLine& line, double prediction,
                      double scale, double number) {
  Coding<Side> coding(side, line, remainders_);
  std::int64_t place = 0;
  bool on_line = true;
  if constexpr (!Side::kReading) {
    place = line.place(number);
    on_line = line.holds(number, place);
  }
  const double scale_in_steps = scale / line.step(prediction);
  if (!(scale_in_steps >= kFine)) {
    return coding.finish(coding.steps(prediction, scale_in_steps, place, on_line), number);
  }
  const auto bound = [&](int bucket) {
    return line.near(prediction + scale * kBounds[static_cast<std::size_t>(bucket)]);
  };
  unsigned bucket = 0;
  if constexpr (!Side::kReading) {
    if (on_line) {
      const double relative = (number - prediction) / scale;
      bucket = static_cast<unsigned>(std::upper_bound(kBounds.begin(), kBounds.end(), relative) -
                                     kBounds.begin());
      // Bounds are compared as places in the end.
      while (bucket > 0 && place < bound(static_cast<int>(bucket) - 1)) --bucket;
      while (bucket < kBuckets - 1 && place >= bound(static_cast<int>(bucket))) ++bucket;
    }
  }
  auto& own = shape_.own[channel];
  unsigned node = 1;
  for (int i = kBucketBits; i-- > 0;) {
    const std::uint64_t of_one =
        (std::uint64_t{shape_.fast[node].of_one} + shape_.slow[node].of_one + own[node].of_one) / 3;
    const auto chance = static_cast<std::uint32_t>(of_one >> 16);
    const bool one = side.chance(65536 - std::clamp(chance, 24u, 65512u), (bucket >> i & 1) != 0);
    shape_.fast[node].learn(one);
    shape_.slow[node].learn(one);
    own[node].learn(one);
    node = node << 1 | (one ? 1 : 0);
  }
  bucket = node - kBuckets;
  if (bucket == 0) {
    const std::int64_t edge = bound(0);
    const std::uint64_t past = distance(edge - 1, place);
    place = moved(edge - 1, coding.magnitude(remainders_.beyond[0], past, on_line), true);
  } else if (bucket == kBuckets - 1) {
    const std::int64_t edge = bound(kBuckets - 2);
    const std::uint64_t past = distance(edge, place);
    place = moved(edge, coding.magnitude(remainders_.beyond[1], past, on_line), false);
  } else {
    place =
        coding.within(bound(static_cast<int>(bucket) - 1), bound(static_cast<int>(bucket)), place);
  }
  return coding.finish(place, number);
}

template <class Side>
double Residual::code_first(Side& side, const NumberLine& line, double number) {
  Coding<Side> coding(side, line, remainders_);
  // Magnitudes are coded as their distance from 1 where the line has decades, else from 0.
  const std::int64_t middle = line.significant() ? line.decade(0) : 0;
  std::int64_t place = 0;
  bool on_line = true;
  if constexpr (!Side::kReading) {
    place = line.place(number);
    on_line = line.holds(number, place);
  }
  const bool negative = side.bit(remainders_.first_negative, place < 0);
  const std::int64_t size = negative ? -1 - place : place;
  const bool below = side.bit(remainders_.first_below, size < middle);
  const std::uint64_t away = coding.magnitude(remainders_.first, distance(middle, size), on_line);
  const std::int64_t coded = moved(middle, away, below);
  return coding.finish(negative ? -1 - coded : coded, number);
}

template double Residual::code(RangeWriting&, std::size_t, const NumberLine&, double, double,
                               double);
template double Residual::code(RangeReading&, std::size_t, const NumberLine&, double, double,
                               double);
template double Residual::code_first(RangeWriting&, const NumberLine&, double);
template double Residual::code_first(RangeReading&, const NumberLine&, double);

}  // namespace mocapress::exact
