#include "near_encoding/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "numbers/wide.hpp"

namespace mocapress::near {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMostNumber = 1 << 29;
// By how much a knot that is off costs more for each frame, in the block behind it.
constexpr double kNextBlock = 0.1;
// Bits beyond the cheapest way to choose numbers at which another is given up: while cuts are
// compared, and for the blocks of the best.
constexpr double kHaste = 4, kCare = 12;

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

// What magnitudes cost.
template <class Vector>
class MagnitudeCosts {
 public:
  explicit MagnitudeCosts(const Model::Place& place) : place_(place) {}

  double of(std::int64_t magnitude, Quantiser quantiser) {
    const double first = more_than_none(quantiser, magnitude > 0);
    if (magnitude == 0) return first;
    const auto known = static_cast<std::size_t>(std::min<std::int64_t>(magnitude, kUnary));
    for (; count_ <= known; ++count_) {
      stops_[count_] = beyond_;
      if (count_ == kUnary) continue;
      const int chance = chance_of(static_cast<int>(count_), quantiser);
      stops_[count_] += bits_of(chance, false);
      beyond_ += bits_of(chance, true);
    }
    if (magnitude < kUnary) return first + stops_[known] + 1;
    const auto above = static_cast<std::uint64_t>(magnitude - kUnary + 1);
    const int length = static_cast<int>(std::bit_width(above)) - 1;
    double bits = first + stops_[known] + 1 + length;
    for (int i = 0; i <= length; ++i) {
      bits += bits_of(chance_of(kUnary + std::min(i, 17), quantiser), i < length);
    }
    return bits;
  }

 private:
  int chance_of(int u, Quantiser quantiser) const {
    return Mixing<Vector>::chance(place_, decision_of(u, quantiser));
  }

  double more_than_none(Quantiser quantiser, bool more) {
    int& chance = firsts_[static_cast<std::size_t>(quantiser)];
    if (chance < 0) chance = chance_of(0, quantiser);
    return bits_of(chance, more);
  }

  Model::Place place_;
  std::array<int, 3> firsts_ = {-1, -1, -1};  // by quantiser; those not asked for yet are below 0
  std::size_t count_ = 1;                     // of the stops that are known
  double beyond_ = 0;
  std::array<double, kUnary + 1> stops_{};  // after the first question
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

// The cheapest numbers of a block's sines that end in each state of the quantisers (Viterbi).
template <class Vector>
class Trellis {
 public:
  // An error of 1 has a `cost` when squared. What is costlier by `hopeless` is given up.
  Trellis(Coder& coder, const Target& target, const Around& around, double cost, double hopeless)
      : coder_(coder), target_(target), around_(around), cost_(cost), hopeless_(hopeless) {
    ways_[0].cost = 0;
  }

  // Goes on to sine k, which is so high.
  MOCAPRESS_IN_PLACE void add(const Block& block, int k, double height) {
    const Surroundings found = surroundings(around_, block, k);
    const double steps = std::fabs(height) / target_.step, most = least() + hopeless_;
    std::array<Way, kStates> next;
    auto& links = links_.emplace_back();
    std::vector<std::pair<Nearest, MagnitudeCosts<Vector>>> known;
    for (std::size_t state = 0; state < kStates; ++state) {
      const Way& way = ways_[state];
      if (way.cost > most) continue;
      std::size_t own = 0;
      while (own < known.size() && known[own].first != way.nearest) ++own;
      if (own == known.size()) {
        const Context context = number_context(around_, found, way.nearest);
        known.emplace_back(way.nearest, MagnitudeCosts<Vector>(coder_.sines.at(context)));
      }
      const bool odd = is_odd(state);
      const auto low =
          static_cast<std::int32_t>(std::min(kMostNumber, (steps / kHalfStep + (odd ? 1 : 0)) / 2));
      for (const std::int32_t size : {0, low, low + 1}) {
        const double off = (steps - height_of(size, odd)) * target_.step;
        const double bits = known[own].second.of(size, odd ? Quantiser::odd : Quantiser::even);
        const double cost = way.cost + cost_ * off * off + target_.bit_cost * bits;
        const std::size_t to = next_state(state, size);
        if (cost >= next[to].cost) continue;
        const auto& [m1, m2, m3, m4] = way.nearest;
        next[to] = {cost, {std::min(size, kMostMagnitude), m1, m2, m3}};
        links[to] = {height < 0 ? -size : size, state};
      }
    }
    ways_ = next;
  }

  double least() const { return cheapest()->cost; }

  std::vector<std::int32_t> numbers() const {
    auto state = static_cast<std::size_t>(cheapest() - ways_.begin());
    std::vector<std::int32_t> found(links_.size());
    for (std::size_t k = links_.size(); k-- > 0;) {
      found[k] = links_[k][state].number;
      state = links_[k][state].from;
    }
    return found;
  }

 private:
  static constexpr std::size_t kStates = kNextState.size();
  struct Way {
    double cost = kInfinite;
    Nearest nearest{};
  };
  struct Link {
    std::int32_t number = 0;
    std::size_t from = 0;
  };

  const Way* cheapest() const {
    return std::min_element(ways_.begin(), ways_.end(),
                            [](const Way& one, const Way& other) { return one.cost < other.cost; });
  }
  Coder& coder_;
  const Target& target_;
  const Around& around_;
  double cost_, hopeless_;
  std::array<Way, kStates> ways_;
  std::vector<std::array<Link, kStates>> links_;
};

// How carefully a block is chosen.
struct Care {
  double hopeless;   // of the ways to choose numbers, in bits beyond the cheapest
  bool tries_knots;  // beside the nearest
};

// What the square of an error costs in a block, on average, and at its end.
struct Costs {
  double middle = 0, end = 0;

  Costs(const double* costs, int n) {
    for (int t = 0; t < n; ++t) middle += costs[t] / n;
    const int tail = std::min(n, 4);
    for (int t = n - tail; t < n; ++t) end += costs[t] / tail;
  }
};

// One block with this knot, its numbers and its curve.
template <class Vector>
MOCAPRESS_IN_PLACE Cut block_of(Coder& coder, const Plan& plan, const Target& target,
                                const Around& around, const Costs& costs, const Care& care,
                                int start, int length, double last, std::int32_t knot) {
  const int n = length;
  const double* const wanted = target.values + start;
  const double cost = costs.middle;
  Cut cut;
  Piece& piece = cut.pieces.emplace_back();
  piece.numbers.assign(static_cast<std::size_t>(n), 0);
  piece.block = {start, n, 0, piece.numbers.data()};
  Block& block = piece.block;
  block.numbers[0] = knot;
  const double end = last + knot * (target.step * plan.knot);

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
  Trellis<Vector> trellis(coder, target, around, cost, care.hopeless * target.bit_cost);
  double best = rest + class_cost(0);
  int best_class = 0, k = 1;
  std::vector<std::int32_t> numbers;
  for (int of_class = 1; of_class <= most; ++of_class) {
    const auto decision = static_cast<std::size_t>(of_class - 1);
    class_bits += bits_of(Mixing<Vector>::chance(class_place, decision), true);
    block.of_class = std::min(of_class + 2, most);
    for (; k <= end_of(of_class, n); ++k) {
      const double height = heights[static_cast<std::size_t>(k)];
      trellis.add(block, k, height);
      rest -= cost * height * height;
    }
    const double sines = trellis.least();
    const double whole = sines + rest + class_cost(of_class);
    if (whole < best) {
      best = whole;
      best_class = of_class;
      numbers = trellis.numbers();
    }
    if (k > top && sines + rest > best + 8 * target.bit_cost) break;
  }
  std::copy(numbers.begin(), numbers.end(), piece.numbers.begin() + 1);
  block.of_class = best_class;
  std::fill(piece.numbers.begin() + end_of(best_class, n) + 1, piece.numbers.end(), 0);
  cut.cost = best;
  cut.curve.resize(static_cast<std::size_t>(n));
  draw(block, last, target.step, plan, cut.curve.data());
  // What errors cost where they are, instead of on average.
  for (int t = 0; t < n - 1; ++t) {
    const double off = cut.curve[static_cast<std::size_t>(t)] - wanted[t];
    cut.cost += (target.costs[start + t] - cost) * off * off;
  }
  return cut;
}

// One block, with the best of the knots that are tried.
template <class Vector>
MOCAPRESS_IN_PLACE Cut block_with(Coder& coder, const Plan& plan, const Target& target,
                                  const Around& around, const Care& care, int start, int length,
                                  double last) {
  const Costs costs(target.costs + start, length);
  const double knot_step = target.step * plan.knot;
  const double wanted = target.values[start + length - 1];
  const Model::Place place = coder.knots.at(knot_context(around, length));
  MagnitudeCosts<Vector> bits(place);
  // Of a knot: what its error costs, `times` as much where others must make it good, and its bits.
  const auto cost_of = [&](std::int32_t knot, double times) {
    const double off = last + knot * knot_step - wanted;
    return target.bit_cost * bits.of(std::abs(knot), Quantiser::only) +
           costs.end * off * off * times;
  };
  double found = 0;
  const std::int32_t near = cheapest(rounded((wanted - last) / knot_step), found,
                                     [&](auto knot) { return cost_of(knot, 1 + 0.15 * length); });
  Cut best;
  double least = kInfinite;
  for (int i = 0; i < (care.tries_knots ? 4 : 1); ++i) {
    const std::int32_t knot = std::array{near, near - 1, near + 1, 0}[static_cast<std::size_t>(i)];
    if (i == 3 && std::abs(near) < 2) break;
    Cut cut = block_of<Vector>(coder, plan, target, around, costs, care, start, length, last, knot);
    const double cost = cut.cost + cost_of(knot, 1 + kNextBlock * length);
    if (i > 0 && cost >= least) continue;  // where no cost is finite, the first
    least = cost;
    cut.cost += cost_of(knot, 1);
    best = std::move(cut);
  }
  return best;
}

template <class Vector>
MOCAPRESS_WIDE MOCAPRESS_FLATTEN Cut wide_block(Coder& coder, const Plan& plan,
                                                const Target& target, const Around& around,
                                                const Care& care, int start, int length,
                                                double last) {
  return block_with<Vector>(coder, plan, target, around, care, start, length, last);
}

MOCAPRESS_FLATTEN Cut narrow_block(Coder& coder, const Plan& plan, const Target& target,
                                   const Around& around, const Care& care, int start, int length,
                                   double last) {
  return block_with<Narrow>(coder, plan, target, around, care, start, length, last);
}

Cut best_block(Coder& coder, const Plan& plan, const Target& target, const Around& around,
               const Care& care, int start, int length, double last) {
  if constexpr (kMayBeWide) {
    if (is_wide()) return wide_block<Wide>(coder, plan, target, around, care, start, length, last);
  }
  return narrow_block(coder, plan, target, around, care, start, length, last);
}

void append(Cut& cut, Cut more) {
  for (Piece& piece : more.pieces) cut.pieces.push_back(std::move(piece));
  cut.curve.insert(cut.curve.end(), more.curve.begin(), more.curve.end());
}

// The cheapest cut, its blocks chosen in haste.
Cut roughly(Coder& coder, std::size_t i, const Plan& plan, const Target& target,
            const Block* before, int start, int length, double last) {
  const Around around = coder.around(i, before, start, length);
  Cut whole = best_block(coder, plan, target, around, {kHaste, false}, start, length, last);
  if (length <= kShortest) return whole;
  const int chance = Mixing<Narrow>::chance(coder.splits.at(split_context(around, length)), 0);
  whole.cost += target.bit_cost * bits_of(chance, false);
  const int half = length / 2;
  Cut first = roughly(coder, i, plan, target, before, start, half, last);
  if (first.cost >= whole.cost) return whole;
  Cut second = roughly(coder, i, plan, target, &first.pieces.back().block, start + half, half,
                       first.curve.back());
  const double cost = first.cost + second.cost + target.bit_cost * bits_of(chance, true);
  if (cost >= whole.cost) return whole;
  first.cost = cost;
  append(first, std::move(second));
  return first;
}

}  // namespace

Cut search(Coder& coder, std::size_t i, const Plan& plan, const Target& target, int length,
           double last) {
  const Cut rough = roughly(coder, i, plan, target, nullptr, 0, length, last);
  Cut found;
  for (const Piece& piece : rough.pieces) {
    const auto [start, own] = std::pair(piece.block.start, piece.block.length);
    const Block* const before = found.pieces.empty() ? nullptr : &found.pieces.back().block;
    append(found, best_block(coder, plan, target, coder.around(i, before, start, own),
                             {kCare, target.tries_knots}, start, own, last));
    last = found.curve.back();
  }
  return found;
}

}  // namespace mocapress::near
