// The decoder of QSSD on any header, model and payload; its encoder on any values, whose payload
// must decode to values within the largest error; and the decoder on such a payload with a byte
// changed.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "fuzz/input.hpp"
#include "qssd/codec.hpp"
#include "qssd_learning/encoder.hpp"

namespace qssd = mocapress::qssd;
using mocapress::Bytes;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;

namespace {

Bytes taken(Input& input, std::size_t size) {
  Bytes bytes;
  for (std::size_t i = 0; i < size; ++i)
    bytes.push_back(static_cast<std::uint8_t>(input.below(256)));
  return bytes;
}

void round_trip(Input& input, const qssd::Plan& plan, std::size_t frames) {
  const double max_error = plan.patch > 0 ? plan.patch / 1.9 : 0;
  const std::size_t size = frames * plan.body.columns;
  std::vector<double> values;
  if (input.below(2) != 0) {
    values = input.numbers(size);
  } else {
    for (std::size_t i = 0; i < size; ++i) values.push_back(input.below(256) * 0.5);
  }
  values.resize(size);
  const std::vector<double> limits(size, max_error);
  Bytes payload = qssd::encode_chunk(values.data(), frames, plan, {4, 0.4, 0.3}, limits.data());
  std::vector<double> decoded(size);
  qssd::decode(payload, decoded.data(), frames, plan);
  for (std::size_t i = 0; i < size; ++i) {
    if (std::isfinite(values[i]) && !(std::fabs(values[i] - decoded[i]) <= max_error)) std::abort();
  }
  payload[input.below(256) % payload.size()] ^= static_cast<std::uint8_t>(1 + input.below(255));
  done([&] { qssd::decode(payload, decoded.data(), frames, plan); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const bool encodes = input.below(2) != 0;
  const std::size_t frames = input.below(40), columns = input.below(12);
  const Bytes header = taken(input, input.below(80)), model = taken(input, input.below(160));
  done([&] {
    const auto plan = qssd::read_plan(header, model, columns);
    if (encodes) {
      round_trip(input, plan, frames);
    } else {
      std::vector<double> values(frames * columns);
      qssd::decode(input.rest(), values.data(), frames, plan);
    }
  });
  return 0;
}
