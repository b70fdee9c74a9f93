// Prints digests of the payloads of `exact` for made-up motion, to compare builds with each other.
#include <cstddef>
#include <string>
#include <vector>

#include "check/motion.hpp"
#include "exact/codec.hpp"
#include "exact/joint.hpp"
#include "exact/tables.hpp"

namespace check = mocapress::check;
namespace exact = mocapress::exact;

namespace {

constexpr std::size_t kFrames = 400, kChannels = 12;

bool check_one(const std::string& name, std::size_t channels, const std::vector<double>& values,
               mocapress::Line line, int digits, int level) {
  const std::size_t frames = values.size() / channels;
  std::vector<exact::Column> columns(channels, {line, digits, false, 0, 0});
  for (std::size_t c = 0; channels == exact::kSkeletonChannels && c < channels; ++c) {
    columns[c].place = static_cast<int>(c);
  }
  columns[0].turns = 1;
  columns[4].turns = 2;
  // Turns about z, y, x with the last one told by the others.
  const std::vector<exact::Coupling> couplings = {
      {0, {0, 1}, {2}, {}},
      {exact::Joint::kKind, {0, 1}, {2}, {59, 0.25, 1, 0, 0.5, -0.125, 1, 0.375}},
      {7, {0, 1, 2, 3, 4}, {5}, {}},
      {1, {3, 4, 5, 6, 7, 8}, {9, 10, 11}, {}}};
  const exact::Start start;
  const exact::Clip clip{columns, couplings, level, start};
  const auto payload = exact::encode(values.data(), frames, clip);
  std::vector<double> decoded(values.size());
  exact::decode(payload, decoded.data(), frames, clip);
  return check::report("exact, " + name + ", level " + std::to_string(level), payload, values,
                       decoded);
}

}  // namespace

int main() {
  bool same = true;
  const auto motion = check::motion(kFrames, kChannels, 1);
  const auto noise = check::noise(60 * kChannels, 2);
  for (const int level : {1, 2, 3, 4, 5, 6, 7, 8, 9, exact::kStrongest}) {
    same &= check_one("on a grid", kChannels, motion, mocapress::Line::decimals, 4, level);
    same &= check_one("in six digits", kChannels, motion, mocapress::Line::significant, 6, level);
    same &= check_one("printed floats", kChannels, motion, mocapress::Line::printed32, 6, level);
    same &= check_one("printed radians", kChannels, motion, mocapress::Line::degrees32, 6, level);
    same &= check_one("motion", kChannels, motion, mocapress::Line::float64, 0, level);
    same &= check_one("noise", kChannels, noise, mocapress::Line::float64, 0, level);
  }
  constexpr std::size_t kAll = exact::kSkeletonChannels;
  for (const int level : {5, 9, exact::kStrongest}) {
    same &= check_one("skeleton", kAll, check::motion(kFrames / 4, kAll, 3),
                      mocapress::Line::decimals, 4, level);
  }
  return same ? 0 : 1;
}
