#include "near_encoding/bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mocapress::near {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kFinenesses = 16;
// How often a correction is tried without one of its channels.
constexpr std::size_t kMostLess = 64;
// Of one channel or two that are enough: of so many joints nearest to a point, so many channels,
// and for so many joints.
constexpr std::size_t kNearest = 8, kMostFew = 32, kMostPaired = 256;
// Of a bound, what is counted on where points are taken to move on lines.
constexpr double kOfBound = 0.999;

double bits_of(const Correction& one) {
  double bits = 11;
  for (const auto& [c, times] : one.added) bits += 8 + 2 * std::log2(std::abs(times));
  return bits;
}

}  // namespace

// What a frame is to be, and what the curves give.
struct Bounds::Row {
  std::size_t frame;
  const double *wanted, *drawn;
};

Bounds::Bounds(const Measure& measure, const std::vector<double>& steps, std::vector<double> most,
               const std::vector<double>& value_most)
    : measure_(measure), steps_(steps), most_(std::move(most)) {
  if (measure.rig) {
    const Rig& rig = *measure.rig;
    of_joint_.resize(rig.joints());
    for (const auto& action : rig.actions()) of_joint_[action.joint].push_back(action.column);
    for (std::size_t j = 0; j < rig.joints(); ++j) {
      const std::int32_t parent = rig.parent(j);
      above_.push_back(parent < 0 || !of_joint_[static_cast<std::size_t>(parent)].empty()
                           ? parent
                           : above_[static_cast<std::size_t>(parent)]);
    }
  } else {
    for (std::size_t c = 0; c < most_.size(); ++c) {
      most_[c] = std::min(most_[c], value_most[c] * measure.others[c]);
    }
  }
  any_ = std::any_of(most_.begin(), most_.end(), [](double one) { return one < kInfinite; });
}

void Bounds::add_beyond(std::size_t frame, const double* errors, std::vector<Beyond>& found) const {
  for (std::size_t p = 0; p < most_.size(); ++p) {
    if (errors[p] <= most_[p]) continue;
    found.push_back({frame, p, errors[p] / most_[p]});
  }
}

std::vector<std::size_t> Bounds::movers(const std::vector<std::size_t>& points,
                                        std::size_t joints) const {
  if (!measure_.rig) return points;
  std::vector<std::size_t> found;
  std::vector<bool> seen(of_joint_.size());
  for (const std::size_t point : points) {
    auto j = static_cast<std::int32_t>(point);
    std::size_t left = joints;
    for (; j >= 0 && left > 0; j = above_[static_cast<std::size_t>(j)]) {
      const auto& own = of_joint_[static_cast<std::size_t>(j)];
      if (!own.empty()) --left;
      if (seen[static_cast<std::size_t>(j)]) {
        if (joints >= of_joint_.size()) break;  // all above are there, too
        continue;
      }
      seen[static_cast<std::size_t>(j)] = true;
      found.insert(found.end(), own.begin(), own.end());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

Mending Bounds::mend(std::size_t frame, const std::vector<std::size_t>& points,
                     const double* wanted, const double* drawn) const {
  const Row row{frame, wanted, drawn};
  Mending best{{frame, 0, {}}, kInfinite};
  if (measure_.rig) choose_few(row, points, best);
  if (!best.correction.added.empty()) return best;
  for (const std::size_t joints : {std::size_t{1}, std::size_t{2}, std::size_t{4}, most_.size()}) {
    choose(row, movers(points, joints), best);
  }
  if (!best.correction.added.empty()) return best;
  std::vector<std::size_t> all(steps_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  choose(row, all, best);
  return best;
}

// What the points of a frame are off, and how far channels move them, as if on lines.
struct Bounds::Few {
  struct Lever {
    std::size_t channel;
    std::vector<Vector> moves;  // of the points, by a step
  };

  std::vector<Vector> off;
  std::vector<double> most;
  std::vector<std::size_t> order;  // of points, those beyond their bounds first
  std::vector<Lever> levers;

  // How many parts of a step a channel must be moved at least, so that all points are within their
  // bounds, when another one is moved by so many steps; 0 where no number of parts is enough.
  double least(const Lever& one, double part, const Lever& other, double steps) const {
    double low = -kInfinite, high = kInfinite;
    for (const std::size_t p : order) {
      const Vector& move = one.moves[p];
      const Vector left = sum(off[p], scaled(other.moves[p], steps));
      const double a = dot(move, move), b = dot(move, left);
      const double c = dot(left, left) - most[p] * most[p], square = b * b - a * c;
      if (a < 1e-12 * most[p] * most[p]) {
        if (c > 0) return 0;
        continue;
      }
      if (!(square >= 0)) return 0;
      low = std::max(low, (-b - std::sqrt(square)) / a);
      high = std::min(high, (-b + std::sqrt(square)) / a);
      if (low > high) return 0;
    }
    const double times = low > 0 ? std::ceil(low / part) : std::floor(high / part);
    const bool is_enough = times * part >= low && times * part <= high;
    return is_enough && std::fabs(times) < 1e6 ? times : 0;
  }

  // How far a channel is best moved for the points that are beyond their bounds.
  double best(const Lever& one, std::size_t beyond) const {
    double squares = 0, products = 0;
    for (std::size_t i = 0; i < beyond; ++i) {
      squares += dot(one.moves[order[i]], one.moves[order[i]]);
      products += dot(one.moves[order[i]], off[order[i]]);
    }
    return squares > 0 ? -products / squares : 0;
  }
};

// The cheapest correction of a channel, or of two, that is enough.
void Bounds::choose_few(const Row& row, const std::vector<std::size_t>& points,
                        Mending& best) const {
  Few few;
  few.off = measure_.places(row.drawn);
  const std::vector<Vector> wanted = measure_.places(row.wanted);
  std::vector<std::size_t> within;
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    few.off[p] = sum(few.off[p], scaled(wanted[p], -1));
    few.most.push_back(kOfBound * most_[p / 4]);
    const bool is_within = dot(few.off[p], few.off[p]) <= few.most[p] * few.most[p];
    (is_within ? within : few.order).push_back(p);
  }
  const std::size_t beyond = few.order.size();
  few.order.insert(few.order.end(), within.begin(), within.end());
  std::vector<double> moved(row.drawn, row.drawn + steps_.size());
  std::vector<std::size_t> candidates = movers(points, kNearest);
  if (candidates.size() > kMostFew) candidates.resize(kMostFew);
  for (const std::size_t c : candidates) {
    if (row.drawn[c] == row.wanted[c]) continue;  // such as what is kept anyway
    moved[c] = row.drawn[c] + steps_[c];
    Few::Lever lever{c, measure_.places(moved.data())};
    moved[c] = row.drawn[c];
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      lever.moves[p] = sum(sum(lever.moves[p], scaled(wanted[p], -1)), scaled(few.off[p], -1));
    }
    few.levers.push_back(std::move(lever));
  }
  const auto consider = [&](Correction one) {
    const double bits = bits_of(one);
    if (bits < best.bits && is_enough(row, one)) best = {std::move(one), bits};
  };
  for (const Few::Lever& one : few.levers) {
    for (int fineness = 0; fineness < kFinenesses; ++fineness) {
      const double times = few.least(one, part_of(1, fineness), one, 0);
      if (times == 0) continue;
      consider({row.frame, fineness, {{one.channel, static_cast<std::int32_t>(times)}}});
      break;
    }
  }
  if (!best.correction.added.empty() || most_.size() > kMostPaired) return;
  for (const Few::Lever& one : few.levers) {
    const double wished = few.best(one, beyond);
    for (int fineness = 0; fineness < kFinenesses / 2; ++fineness) {
      const double part = part_of(1, fineness), first = std::round(wished / part);
      if (first == 0 || std::fabs(first) > 64) continue;
      for (const Few::Lever& other : few.levers) {
        if (other.channel == one.channel) continue;
        const double second = few.least(other, part, one, first * part);
        if (second == 0) continue;
        Correction both{row.frame,
                        fineness,
                        {{one.channel, static_cast<std::int32_t>(first)},
                         {other.channel, static_cast<std::int32_t>(second)}}};
        std::sort(both.added.begin(), both.added.end());
        consider(std::move(both));
      }
    }
  }
}

// The coarsest correction of these channels that is enough, without what it can do without, if it
// is cheaper than the best so far.
void Bounds::choose(const Row& row, const std::vector<std::size_t>& candidates,
                    Mending& best) const {
  for (int fineness = 0; fineness < kFinenesses; ++fineness) {
    Correction one = moved_back(row, candidates, fineness);
    if (one.added.empty() || !is_enough(row, one)) continue;
    std::size_t tries = kMostLess;
    for (std::size_t k = one.added.size(); k-- > 0 && one.added.size() > 1 && tries-- > 0;) {
      Correction fewer = one;
      fewer.added.erase(fewer.added.begin() + static_cast<std::ptrdiff_t>(k));
      if (is_enough(row, fewer)) one = std::move(fewer);
    }
    const double bits = bits_of(one);
    if (bits < best.bits) best = {std::move(one), bits};
    return;
  }
}

// Whether a frame is within its bounds with a correction.
bool Bounds::is_enough(const Row& row, const Correction& one) const {
  std::vector<double> mended(row.drawn, row.drawn + steps_.size()), errors(most_.size());
  for (const auto& [c, times] : one.added) mended[c] += times * part_of(steps_[c], one.fineness);
  measure_.errors(row.wanted, mended.data(), steps_.size(), errors.data());
  for (std::size_t p = 0; p < most_.size(); ++p) {
    if (!(errors[p] <= most_[p])) return false;
  }
  return true;
}

// These channels, moved to the nearest part of a step.
Correction Bounds::moved_back(const Row& row, const std::vector<std::size_t>& candidates,
                              int fineness) const {
  Correction one{row.frame, fineness, {}};
  for (const std::size_t c : candidates) {
    const double times = std::round((row.wanted[c] - row.drawn[c]) / part_of(steps_[c], fineness));
    if (times == 0 || std::fabs(times) > 1e9) continue;
    one.added.emplace_back(c, static_cast<std::int32_t>(times));
  }
  return one;
}

}  // namespace mocapress::near
