// Prints digests of APP's payloads of made-up motion, to compare builds with each other.
#include <cstddef>
#include <string>
#include <vector>

#include "app/codec.hpp"
#include "check/motion.hpp"

namespace app = mocapress::app;
namespace check = mocapress::check;

namespace {

constexpr std::size_t kFrames = 600, kChannels = 12;
constexpr double kAlphas[] = {-1, -1.0 / 3, 0, 1.0 / 3, 0.5, 2.0 / 3, 1, 5.0 / 3};

std::vector<app::Column> columns_on(mocapress::Line line) {
  std::vector<app::Column> columns(kChannels);
  for (std::size_t c = 0; c < kChannels; ++c) {
    columns[c] = {static_cast<std::int32_t>(c) - 1, app::Precision::float64, line, 4};
  }
  return columns;
}

bool check_one(const std::string& name, const std::vector<double>& values, mocapress::Line line,
               const app::Parameters& parameters) {
  const std::size_t frames = values.size() / kChannels;
  auto columns = columns_on(line);
  const auto precisions = app::precisions(values.data(), frames, columns);
  for (std::size_t c = 0; c < kChannels; ++c) columns[c].precision = precisions[c];
  const auto payload = app::encode(values.data(), frames, columns, parameters);
  std::vector<double> decoded(values.size());
  app::decode(payload, decoded.data(), frames, columns, parameters);
  return check::report("app, " + name + ", t " + std::to_string(parameters.cluster) + ", limit " +
                           std::to_string(parameters.mantissa_limit),
                       payload, values, decoded);
}

}  // namespace

int main() {
  bool same = true;
  const auto motion = check::motion(kFrames, kChannels, 1);
  const auto noise = check::noise(60 * kChannels, 2);
  for (const std::size_t cluster : {std::size_t{5}, std::size_t{15}}) {
    for (const int limit : {12, 53}) {
      const app::Parameters parameters{kAlphas, cluster, limit};
      same &= check_one("on a grid", motion, mocapress::Line::decimals, parameters);
      same &= check_one("motion", motion, mocapress::Line::float64, parameters);
      same &= check_one("noise", noise, mocapress::Line::float64, parameters);
    }
    const auto alphas =
        app::ideal_alphas(motion.data(), kFrames, columns_on(mocapress::Line::float64), cluster);
    check::report("app, ideal alphas, t " + std::to_string(cluster), alphas);
  }
  return same ? 0 : 1;
}
