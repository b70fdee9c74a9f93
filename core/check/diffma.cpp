// Prints digests of DiffMA's opcodes, tables and decoded values of made-up motion, to compare
// builds with each other.
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "check/motion.hpp"
#include "diffma/codec.hpp"

namespace diffma = mocapress::diffma;
namespace check = mocapress::check;

namespace {

constexpr std::size_t kFrames = 600, kChannels = 12;
constexpr double kMaxError = 0.5;

bool check_one(const std::string& name, const std::vector<double>& values,
               const diffma::Parameters& parameters) {
  const auto record = diffma::encode(values, parameters, {10.0, 0.5, kMaxError, false});
  std::vector<double> decoded(values.size());
  diffma::decode(record.opcodes, record.table, parameters, decoded);
  const std::string what = "diffma, " + name + ", n " + std::to_string(parameters.bits) + ", w " +
                           std::to_string(parameters.window) + ", order " +
                           std::to_string(parameters.order);
  const std::span<const char> text(record.opcodes);
  std::printf("%s: %zu opcodes, %016llx\n", what.c_str(), text.size(),
              static_cast<unsigned long long>(check::digest(text.data(), text.size())));
  check::report(what + ", table", record.table);
  check::report(what + ", values", decoded);
  // Which bounds are chosen hangs on it.
  check::report(what + ", squared error", std::span(&record.squared_error, 1));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && !(std::abs(values[i] - decoded[i]) <= kMaxError)) {
      std::printf("%s: NOT RESTORED\n", what.c_str());
      return false;
    }
  }
  return true;
}

// Channels one behind the other.
std::vector<double> by_channel(const std::vector<double>& rows) {
  std::vector<double> values(rows.size());
  const std::size_t frames = rows.size() / kChannels;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    values[i % kChannels * frames + i / kChannels] = rows[i];
  }
  return values;
}

}  // namespace

int main() {
  bool same = true;
  const auto motion = by_channel(check::motion(kFrames, kChannels, 1));
  const auto noise = check::noise(60 * kChannels, 2);
  for (const int bits : {6, 9}) {
    for (const std::size_t window : {std::size_t{64}, std::size_t{7}}) {
      for (const int order : {0, 2}) {
        // No power of two, so that every product is rounded.
        const diffma::Parameters parameters{bits, window, 5.3, order};
        same &= check_one("motion", motion, parameters);
        same &= check_one("noise", noise, parameters);
      }
    }
  }
  return same ? 0 : 1;
}
