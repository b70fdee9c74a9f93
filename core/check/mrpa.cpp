// Prints digests of MRPA's payloads of made-up motion, to compare builds with each other.
#include <cstddef>
#include <string>
#include <vector>

#include "app/codec.hpp"
#include "check/motion.hpp"
#include "mrpa/codec.hpp"

namespace app = mocapress::app;
namespace check = mocapress::check;
namespace mrpa = mocapress::mrpa;

namespace {

constexpr std::size_t kFrames = 600, kChannels = 12;

bool check_one(const std::string& name, const std::vector<double>& values,
               const std::vector<double>& parents, mocapress::Line line, int limit,
               mrpa::Choice choice) {
  const std::size_t frames = values.size() / kChannels;
  std::vector<app::Column> columns(kChannels, {-1, app::Precision::float64, line, 4});
  const auto precisions = app::precisions(values.data(), frames, columns);
  for (std::size_t c = 0; c < kChannels; ++c) columns[c].precision = precisions[c];
  const std::vector<mrpa::Piece> pieces{{frames / 3, false, false},
                                        {frames / 3, true, false},
                                        {frames - 2 * (frames / 3), true, true}};
  const mrpa::Rows rows{values.data(), parents.data(), pieces, columns};
  const auto payload = mrpa::encode(rows, limit, choice);
  std::vector<double> decoded(values.size());
  mrpa::decode(payload, decoded.data(), parents.data(), pieces, columns, limit);
  check::report("mrpa, " + name + ", choice " + std::to_string(static_cast<int>(choice)) +
                    ", estimate, limit " + std::to_string(limit),
                mrpa::estimated_bits(rows));
  return check::report("mrpa, " + name + ", choice " + std::to_string(static_cast<int>(choice)) +
                           ", limit " + std::to_string(limit),
                       payload, values, decoded);
}

}  // namespace

int main() {
  bool same = true;
  const auto motion = check::motion(kFrames, kChannels, 1);
  const auto other = check::motion(kFrames, kChannels, 2);
  const auto noise = check::noise(60 * kChannels, 2);
  for (const auto choice : {mrpa::Choice::published, mrpa::Choice::previous, mrpa::Choice::best}) {
    for (const int limit : {12, 53}) {
      same &= check_one("on a grid", motion, other, mocapress::Line::decimals, limit, choice);
      same &= check_one("motion", motion, other, mocapress::Line::float64, limit, choice);
      same &= check_one("noise", noise, noise, mocapress::Line::float64, limit, choice);
    }
  }
  return same ? 0 : 1;
}
