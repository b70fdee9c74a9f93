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
  for (const std::size_t joints : {std::size_t{1}, std::size_t{2}, std::size_t{4}, most_.size()}) {
    choose(row, movers(points, joints), best);
  }
  if (!best.correction.added.empty()) return best;
  std::vector<std::size_t> all(steps_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  choose(row, all, best);
  return best;
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
    double bits = 8;
    for (const auto& [c, times] : one.added) bits += 6 + 2 * std::log2(std::abs(times));
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
