// The decoder of `near` on any header and payload; its encoder on any values, whose payload must
// keep their bounds; and the decoder on such a payload with one byte changed, or cut off.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "fuzz/input.hpp"
#include "near/codec.hpp"
#include "near_encoding/encoder.hpp"

namespace near = mocapress::near;
using mocapress::Bytes;
using mocapress::ByteView;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;

namespace {

constexpr double kMost = 0.01;

bool decodes(ByteView payload, std::vector<double>& values, std::size_t frames,
             const near::Plan& plan) {
  return done([&] { near::decode(payload, values.data(), frames, plan); });
}

near::Plan plan_of(Input& input, std::size_t channels, bool turns) {
  near::Plan plan;
  for (std::size_t c = 0; c < channels; ++c) {
    plan.steps.push_back(near::step_of(static_cast<int>(input.below(64)) * 32 - 1024));
    plan.joints.of_column.push_back(static_cast<std::int32_t>(c));
    plan.joints.parents.push_back(static_cast<std::int32_t>(input.below(unsigned(c) + 1)) - 1);
  }
  if (turns && channels > 2) {
    const auto order = [&] { return static_cast<std::uint8_t>(input.below(6)); };
    plan.turnings.push_back({channels - 3, order(), order(), order(), input.below(2) != 0});
  }
  return plan;
}

void round_trip(Input input, std::size_t channels) {
  near::Task task;
  task.plan = plan_of(input, channels, false);
  task.scale = 0.01;
  task.weights.assign(channels, 1.0);
  task.most.assign(channels, std::numeric_limits<double>::infinity());
  task.value_most.assign(channels, kMost);
  task.rounds = 1;
  near::Measure measure;
  measure.others.assign(channels, 1.0);
  const unsigned change = input.below(256), cut = input.below(256);
  const bool any_bits = input.below(2) != 0;
  std::vector<double> values;
  if (any_bits) {
    values = input.numbers(1 << 10);
  } else {
    for (const std::uint8_t byte :
         input.rest().first(std::min<std::size_t>(input.rest().size(), 1 << 10)))
      values.push_back((byte - 128) / 7.0);
  }
  const std::size_t frames = channels > 0 ? values.size() / channels : 0;
  values.resize(frames * channels);
  if (frames == 0) return;
  const near::Coded coded = near::encode(values.data(), frames, task, measure, measure);
  std::vector<double> decoded(values.size());
  if (!decodes(coded.payload, decoded, frames, task.plan)) std::abort();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool same = values[i] == decoded[i] || (std::isnan(values[i]) && std::isnan(decoded[i]));
    if (!same && !(std::fabs(values[i] - decoded[i]) <= kMost)) std::abort();
  }
  Bytes changed = coded.payload;
  changed[change % changed.size()] ^= static_cast<std::uint8_t>(1 + cut % 255);
  decodes(changed, decoded, frames, task.plan);
  if (decodes(ByteView(coded.payload).first(cut % coded.payload.size()), decoded, frames,
              task.plan)) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const bool encodes = input.below(16) == 0;  // which takes a hundred times as long
  const std::size_t channels = input.below(9);
  if (encodes) {
    round_trip(input, channels);
    return 0;
  }
  const std::size_t frames = input.below(200);
  const ByteView rest = input.rest();
  const std::size_t split = rest.empty() ? 0 : rest.front() % rest.size();
  near::Plan plan;
  const bool told = done([&] { plan = near::read_header(rest.first(split), channels); });
  if (!told) plan = plan_of(input, channels, true);
  std::vector<double> values(frames * channels);
  decodes(rest.subspan(split), values, frames, plan);
  return 0;
}
