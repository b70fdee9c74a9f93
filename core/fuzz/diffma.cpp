// DiffMA's decoder on any opcodes and tables; its encoder on any values: what it makes must be read
// again, keep the largest error, and cost the same table with spared signs.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include "diffma/codec.hpp"
#include "fuzz/input.hpp"

namespace diffma = mocapress::diffma;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;
using mocapress::fuzz::same_bits;

namespace {

void decode_anything(Input& input, const diffma::Parameters& parameters) {
  const auto table = input.numbers(input.below(16));
  const auto asked = diffma::scan(input.text(), parameters.bits);
  for (const std::size_t frames : {asked.steps + 1, asked.steps, std::size_t{0}}) {
    std::vector<double> values(frames);
    done([&] { diffma::decode(input.text(), table, parameters, values); });
  }
}

void round_trip(Input& input, const diffma::Parameters& parameters) {
  const bool small = input.below(2) != 0;
  const double max_error = input.below(2) != 0 ? 0.25 : std::numeric_limits<double>::infinity();
  std::vector<double> values;
  if (small) {
    for (const char c : input.text()) values.push_back(static_cast<signed char>(c) * 0.0625);
  } else {
    values = input.numbers(1024);
  }
  std::vector<double> decoded(values.size()), again(values.size());
  for (const bool spare_signs : {false, true}) {
    const auto record = diffma::encode(values, parameters, {10.0, 0.5, max_error, spare_signs});
    diffma::decode(record.opcodes, record.table, parameters, spare_signs ? again : decoded);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool exact = same_bits({&values[i], 1}, {&decoded[i], 1});
    if (!exact && !(std::abs(values[i] - decoded[i]) <= max_error)) std::abort();
    if (decoded[i] != again[i] && !std::isnan(decoded[i])) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const bool encodes = input.below(2) != 0;
  const diffma::Parameters parameters{
      1 + static_cast<int>(input.below(diffma::kMostBits)), 1 + input.below(80),
      std::ldexp(1.0, static_cast<int>(input.below(40)) - 20), static_cast<int>(input.below(8))};
  if (encodes) {
    round_trip(input, parameters);
  } else {
    decode_anything(input, parameters);
  }
  return 0;
}
