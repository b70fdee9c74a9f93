// The decoder of `exact` on any bytes; its encoder on any values on any lines, whose payload must
// decode to them; and the decoder on such a payload with one byte changed, or cut off.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "exact/codec.hpp"
#include "fuzz/input.hpp"

namespace exact = mocapress::exact;
using mocapress::Bytes;
using mocapress::ByteView;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;
using mocapress::fuzz::same_bits;

namespace {

constexpr int kLevels[] = {1, 2, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

exact::Column column_of(Input& input, bool noise) {
  constexpr int kDigits[] = {0, 1, 4, 6, 15};
  const auto line = static_cast<mocapress::Line>(input.below(7));
  const bool none = line == mocapress::Line::float64 || line == mocapress::Line::float32 ||
                    line == mocapress::Line::shortest32;
  const int few = line == mocapress::Line::significant ? 1 : 0;
  const unsigned chosen = input.below(5);
  const auto exponent = static_cast<int>(input.below(64)) - 32;
  const bool far = input.below(8) == 0;
  return {line, none ? 0 : std::max(kDigits[chosen], few), noise, far ? 31 * exponent : exponent,
          static_cast<int>(input.below(3))};
}

// Small chains: every kind that the columns are enough for.
std::vector<exact::Coupling> couplings_of(Input& input, std::size_t predicted) {
  switch (input.below(4)) {
    case 0:
      if (predicted >= 3) return {{0, {0, 1}, {2}, {}}};
      break;
    case 1:
      if (predicted >= 4) return {{3 + static_cast<int>(input.below(2)), {0, 1}, {2, 3}, {}}};
      break;
    case 2:
      if (predicted >= 9) {
        return {{1 + static_cast<int>(input.below(2)), {0, 1, 2, 3, 4, 5}, {6, 7, 8}, {}}};
      }
      break;
    default:
      break;
  }
  return {};
}

// Numbers as columns hold them, numbers of any size, and any bits, as the input has it.
void fill(std::vector<double>& values, Input input) {
  const unsigned kind = input.below(4);
  ByteView bytes = input.rest();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (kind == 0) {
      if (bytes.size() < sizeof(double)) break;
      std::memcpy(&values[i], bytes.data(), sizeof(double));
      bytes = bytes.subspan(sizeof(double));
      continue;
    }
    if (bytes.size() < 2) break;
    const int number = bytes[0] | bytes[1] << 8;
    bytes = bytes.subspan(2);
    const double unit = kind == 1 ? 1e4 : kind == 2 ? 1e-10 : static_cast<double>(1 + i % 977);
    values[i] = (number - 32768) / unit;
  }
}

bool decodes(ByteView payload, std::vector<double>& values, std::size_t frames,
             const exact::Clip& clip) {
  return done([&] { exact::decode(payload, values.data(), frames, clip); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const bool round_trip = input.below(2) != 0;
  const int level = kLevels[input.below(sizeof(kLevels) / sizeof(int))];
  const std::size_t frames = input.below(40);
  const std::size_t count = 1 + input.below(12);
  const std::size_t noisy = input.below(3) == 0 ? input.below(static_cast<unsigned>(count)) : 0;
  std::vector<exact::Column> columns;
  columns.reserve(count);
  for (std::size_t c = 0; c < count; ++c) columns.push_back(column_of(input, c >= count - noisy));
  const auto couplings = couplings_of(input, count - noisy);
  const exact::Start start;
  const exact::Clip clip{columns, couplings, level, start};
  std::vector<double> decoded(frames * count);
  if (!round_trip) {
    decodes(input.rest(), decoded, frames, clip);
    return 0;
  }
  const unsigned at = input.below(256);
  const auto change = static_cast<std::uint8_t>(1 + input.below(255));
  std::vector<double> values(decoded.size());
  fill(values, input);
  Bytes payload = exact::encode(values.data(), frames, clip);
  if (!decodes(payload, decoded, frames, clip)) std::abort();
  if (!same_bits(values, decoded)) std::abort();
  std::vector<double> first(frames / 2 * count);
  exact::decode(payload, first.data(), frames / 2, clip, false);
  if (!same_bits(std::span(values).first(first.size()), first)) std::abort();
  if (payload.empty()) return 0;
  const std::size_t place = at * payload.size() / 256;
  if (frames > 0 && decodes(ByteView(payload).first(place), decoded, frames, clip) && level <= 2) {
    std::abort();  // the fast levels see every cut
  }
  payload[place] ^= change;
  decodes(payload, decoded, frames, clip);
  return 0;
}
