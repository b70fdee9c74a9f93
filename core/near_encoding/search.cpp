#include "near_encoding/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numbers/wide.hpp"

namespace mocapress::near {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMostNumber = 1 << 29;

// Bits that a decision costs of this chance, in 1/65536.
double bits_of(int chance) {
  static const auto kBits = [] {
    std::vector<double> made(4097);
    for (std::size_t i = 0; i < made.size(); ++i) {
      made[i] = -std::log2((static_cast<double>(i) * 16 + 8) / 65536);
    }
    return made;
  }();
  return kBits[static_cast<std::size_t>(chance) >> 4];
}

double bits_of(int chance_of_one, bool one) {
  return bits_of(one ? chance_of_one : 65536 - chance_of_one);
}

// What magnitudes cost, asked for in rising order or again.
template <class Vector>
class MagnitudeCosts {
 public:
  explicit MagnitudeCosts(const Model::Place& place) : place_(place) {}

  double of(std::int64_t magnitude) {
    const auto known = static_cast<std::size_t>(std::min<std::int64_t>(magnitude, kUnary));
    while (count_ <= known) {
      if (count_ < kUnary) {
        const int chance = Mixing<Vector>::chance(place_, count_);
        stops_[count_] = beyond_ + bits_of(chance, false);
        beyond_ += bits_of(chance, true);
      } else {
        stops_[count_] = beyond_;
      }
      ++count_;
    }
    const double sign = magnitude > 0 ? 1 : 0;
    if (magnitude < kUnary) return stops_[known] + sign;
    const auto above = static_cast<std::uint64_t>(magnitude - kUnary + 1);
    const int length = static_cast<int>(std::bit_width(above)) - 1;
    double bits = stops_[known] + sign + length;
    for (int i = 0; i <= length; ++i) {
      const auto decision = static_cast<std::size_t>(kUnary + std::min(i, 17));
      bits += bits_of(Mixing<Vector>::chance(place_, decision), i < length);
    }
    return bits;
  }

 private:
  const Model::Place& place_;
  std::size_t count_ = 0;
  double beyond_ = 0;
  std::array<double, kUnary + 1> stops_{};
};

std::int32_t rounded(double value) {
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -kMostNumber, kMostNumber)));
}

// A number, the one nearer to zero, and zero: whichever costs the least.
template <class Cost>
std::int32_t cheapest(std::int32_t number, double& cost, Cost&& cost_of) {
  std::int32_t best = 0;
  cost = kInfinite;
  const std::int32_t nearer = number > 0 ? number - 1 : number < 0 ? number + 1 : 0;
  std::int32_t tried = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t one : {0, nearer, number}) {
    if (one == tried) continue;
    tried = one;
    const double found = cost_of(one);
    if (found < cost) {
      cost = found;
      best = one;
    }
  }
  return best;
}

// One block, its numbers and its curve.
template <class Vector>
MOCAPRESS_IN_PLACE Cut block_with(Coder& coder, const Plan& plan, const Target& target,
                                  const Around& around, int start, int length, double last) {
  const int n = length;
  const double* const wanted = target.values + start;
  const double* const costs = target.costs + start;
  Cut cut;
  Piece& piece = cut.pieces.emplace_back();
  piece.numbers.assign(static_cast<std::size_t>(n), 0);
  piece.block = {start, n, 0, piece.numbers.data()};
  Block& block = piece.block;
  double cost = 0, end_cost = 0;
  for (int t = 0; t < n; ++t) cost += costs[t] / n;
  const int tail = std::min(n, 4);
  for (int t = n - tail; t < n; ++t) end_cost += costs[t] / tail;

  const double knot_step = target.step * plan.knot;
  const Model::Place knot_place = coder.knots.at(knot_context(around, n));
  MagnitudeCosts<Vector> knot_costs(knot_place);
  double found = 0;
  const auto knot = cheapest(rounded((wanted[n - 1] - last) / knot_step), found, [&](auto q) {
    const double off = last + q * knot_step - wanted[n - 1];
    return target.bit_cost * knot_costs.of(std::abs(q)) + end_cost * off * off * (1 + 0.15 * n);
  });
  block.numbers[0] = knot;
  const double end = last + knot * knot_step, off = end - wanted[n - 1];
  cut.cost = end_cost * off * off + target.bit_cost * knot_costs.of(std::abs(knot));

  // The sines of what the line leaves.
  std::vector<double> heights(static_cast<std::size_t>(n), 0.0);
  double rest = 0;
  for (int t = 1; t < n; ++t) {
    const double left = wanted[t - 1] - (last + (end - last) * t / n);
    const double* const wave = sine(n, t).data();
    for (int k = 1; k < n; ++k) heights[static_cast<std::size_t>(k)] += wave[k - 1] * left;
  }
  int top = 0;
  for (int k = 1; k < n; ++k) {
    const double height = heights[static_cast<std::size_t>(k)];
    rest += cost * height * height;
    if (std::fabs(height) > 0.5 * target.step) top = k;
  }

  const Model::Place class_place = coder.classes.at(class_context(around, n, knot));
  const int most = classes_of(n) - 1;
  double class_bits = 0;
  const auto class_cost = [&](int of_class) {
    double bits = class_bits;
    if (of_class < most) {
      bits +=
          bits_of(Mixing<Vector>::chance(class_place, static_cast<std::size_t>(of_class)), false);
    }
    return target.bit_cost * bits;
  };
  double sines = 0, best = rest + class_cost(0);
  int best_class = 0, k = 1;
  for (int of_class = 1; of_class <= most; ++of_class) {
    const auto decision = static_cast<std::size_t>(of_class - 1);
    class_bits += bits_of(Mixing<Vector>::chance(class_place, decision), true);
    block.of_class = std::min(of_class + 2, most);
    for (; k <= end_of(of_class, n); ++k) {
      const double height = heights[static_cast<std::size_t>(k)] / target.step;
      const Model::Place place = coder.sines.at(number_context(around, block, k));
      MagnitudeCosts<Vector> number_costs(place);
      double one = 0;
      block.numbers[k] = cheapest(rounded(height), one, [&](auto q) {
        const double drawn = std::abs(q) == 1 ? q * plan.first : q;
        const double apart = (height - drawn) * target.step;
        return cost * apart * apart + target.bit_cost * number_costs.of(std::abs(q));
      });
      sines += one;
      rest -= cost * heights[static_cast<std::size_t>(k)] * heights[static_cast<std::size_t>(k)];
    }
    const double whole = sines + rest + class_cost(of_class);
    if (whole < best) {
      best = whole;
      best_class = of_class;
    }
    if (k > top && sines + rest > best + 8 * target.bit_cost) break;
  }
  block.of_class = best_class;
  std::fill(piece.numbers.begin() + end_of(best_class, n) + 1, piece.numbers.end(), 0);
  cut.cost += best;
  cut.curve.resize(static_cast<std::size_t>(n));
  draw(block, last, target.step, plan, cut.curve.data());
  return cut;
}

template <class Vector>
MOCAPRESS_WIDE MOCAPRESS_FLATTEN Cut wide_block(Coder& coder, const Plan& plan,
                                                const Target& target, const Around& around,
                                                int start, int length, double last) {
  return block_with<Vector>(coder, plan, target, around, start, length, last);
}

MOCAPRESS_FLATTEN Cut narrow_block(Coder& coder, const Plan& plan, const Target& target,
                                   const Around& around, int start, int length, double last) {
  return block_with<Narrow>(coder, plan, target, around, start, length, last);
}

Cut best_block(Coder& coder, const Plan& plan, const Target& target, const Around& around,
               int start, int length, double last) {
  if constexpr (kMayBeWide) {
    if (is_wide()) return wide_block<Wide>(coder, plan, target, around, start, length, last);
  }
  return narrow_block(coder, plan, target, around, start, length, last);
}

}  // namespace

Cut search(Coder& coder, std::size_t i, const Plan& plan, const Target& target, const Block* before,
           int start, int length, double last) {
  const Around around = coder.around(i, before, start, length);
  Cut whole = best_block(coder, plan, target, around, start, length, last);
  if (length <= kShortest) return whole;
  const int chance = Mixing<Narrow>::chance(coder.splits.at(split_context(around, length)), 0);
  whole.cost += target.bit_cost * bits_of(chance, false);
  const int half = length / 2;
  Cut first = search(coder, i, plan, target, before, start, half, last);
  if (first.cost >= whole.cost) return whole;
  const Cut second = search(coder, i, plan, target, &first.pieces.back().block, start + half, half,
                            first.curve.back());
  const double cost = first.cost + second.cost + target.bit_cost * bits_of(chance, true);
  if (cost >= whole.cost) return whole;
  first.cost = cost;
  for (const Piece& piece : second.pieces) {
    first.pieces.push_back(piece);
    first.pieces.back().block.numbers = first.pieces.back().numbers.data();
  }
  first.curve.insert(first.curve.end(), second.curve.begin(), second.curve.end());
  return first;
}

}  // namespace mocapress::near
