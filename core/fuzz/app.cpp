// APP's decoder on any bytes; its encoder on any values, whose payload must decode to them; and the
// decoder on such a payload with one byte changed.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "app/codec.hpp"
#include "fuzz/input.hpp"

namespace app = mocapress::app;
using mocapress::Bytes;
using mocapress::ByteView;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;
using mocapress::fuzz::same_bits;

namespace {

constexpr double kAlphas[] = {-1, -0.5, -0.25, 0, 0.25, 0.5, 1, 2};

bool decodes(ByteView payload, std::vector<double>& values, std::size_t frames,
             std::span<const app::Column> columns, const app::Parameters& parameters) {
  return done([&] { app::decode(payload, values.data(), frames, columns, parameters); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const bool round_trip = input.below(2) != 0;
  const std::size_t frames = input.below(64);
  std::vector<app::Column> columns(input.below(9));
  const app::Parameters parameters{{kAlphas, std::size_t{1} << input.below(4)},
                                   1 + input.below(20),
                                   1 + static_cast<int>(input.below(53))};
  for (auto& column : columns) {
    column.parent =
        static_cast<std::int32_t>(input.below(static_cast<unsigned>(columns.size()) + 1)) - 1;
    column.precision = static_cast<app::Precision>(input.below(3));
    const auto line = static_cast<int>(input.below(7));
    column.digits = static_cast<int>(input.below(30)) - 2;
    const bool exists = mocapress::line_exists(line, column.digits);
    column.line = exists ? static_cast<mocapress::Line>(line) : mocapress::Line::float64;
  }
  std::vector<double> decoded(frames * columns.size());
  if (!round_trip) {
    decodes(input.rest(), decoded, frames, columns, parameters);
    return 0;
  }

  std::vector<double> values = Input(input).numbers(decoded.size());
  values.resize(decoded.size());
  Bytes payload;
  if (!done([&] {
        const auto precisions = app::precisions(values.data(), frames, columns);
        for (std::size_t c = 0; c < columns.size(); ++c) columns[c].precision = precisions[c];
        payload = app::encode(values.data(), frames, columns, parameters);
      })) {
    return 0;  // the parents are no tree
  }
  if (!decodes(payload, decoded, frames, columns, parameters)) std::abort();
  if (!same_bits(values, decoded)) std::abort();
  payload[input.below(256) % payload.size()] ^= static_cast<std::uint8_t>(1 + input.below(255));
  decodes(payload, decoded, frames, columns, parameters);
  return 0;
}
