// The decoder of patterns on any header, model and payload; its encoder on any values, whose
// payload must decode to values within the largest error; and the decoder on such a payload with a
// byte changed.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "fuzz/input.hpp"
#include "patterns/codec.hpp"

namespace patterns = mocapress::patterns;
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

// A header that is one: a track, and a node of the other columns with one pattern.
Bytes header_of(Input& input, std::size_t columns) {
  const auto count = static_cast<std::uint8_t>(columns);
  Bytes bytes = {0};
  bytes.resize(1 + 8 * 6);
  for (const std::size_t place : {2, 3, 4, 5, 6}) bytes[8 * place - 1] = 0x3f;  // steps near 1
  for (const std::size_t place : {2, 3, 4, 5, 6}) bytes[8 * place] = 0x3f;
  bytes.push_back(static_cast<std::uint8_t>(input.below(4)));
  bytes.insert(bytes.end(), {count, 0, 1});
  if (columns > 1) bytes.insert(bytes.end(), {3, static_cast<std::uint8_t>(count - 1)});
  bytes.insert(bytes.end(), {0, count, static_cast<std::uint8_t>(input.below(4))});
  bytes.resize(bytes.size() + 7);
  bytes.push_back(0x3f);
  const auto components = static_cast<std::uint8_t>(columns - 1);
  if (columns > 1)
    bytes.insert(bytes.end(), {static_cast<std::uint8_t>(1 + input.below(30)), 1, components, 16});
  patterns::Plan plan =
      patterns::read_body_alone(mocapress::ByteView(bytes).subspan(1 + 8 * 6 + 1), columns);
  for (patterns::Node& node : plan.nodes) {
    for (std::size_t i = 0; i < node.components * node.columns.size(); ++i) {
      node.basis.push_back(static_cast<std::int64_t>(input.below(256)) * 4 - 512);
    }
    node.centre.assign(node.columns.size(), input.below(9));
    node.starts.assign(1, 0);
    for (std::size_t s = 0; s < node.components; ++s) {
      node.terms.push_back(1 + input.below(5));
      node.starts.push_back(static_cast<std::uint32_t>(s + 1));
    }
    node.first.assign(node.components, 3);
    node.quantisers = {-1.0F, 0.01F};
    node.differences.assign((node.frames - 1) * node.components, 7);
  }
  const Bytes database = patterns::write_database(plan);
  for (std::size_t size = database.size();; size >>= 7) {
    bytes.push_back(static_cast<std::uint8_t>(size >= 0x80 ? size | 0x80 : size));
    if (size < 0x80) break;
  }
  bytes.insert(bytes.end(), database.begin(), database.end());
  return bytes;
}

void round_trip(Input& input, const patterns::Plan& plan, std::size_t frames, std::size_t columns) {
  const double max_error = plan.correction > 0 ? plan.correction / 1.9 : 0;
  std::vector<double> values = input.numbers(frames * columns);
  for (std::size_t i = values.size(); i < frames * columns; ++i) {
    values.push_back(static_cast<double>(input.below(256)));
  }
  std::vector<double> filled = values, projections;
  std::vector<std::uint8_t> kept(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::fabs(values[i]) < 1e12) continue;
    filled[i] = 0;
    kept[i] = 1;
  }
  std::vector<patterns::Segments> segments(plan.nodes.size());
  for (std::size_t n = 0; n < segments.size(); ++n) {
    for (std::size_t left = frames; left > 0;) {
      const std::size_t size = std::min<std::size_t>(left, 1 + input.below(20));
      segments[n].frames.push_back(size);
      segments[n].patterns.push_back(0);
      left -= size;
    }
    const patterns::Node& node = plan.nodes[n];
    projections.resize(projections.size() + node.components * node.columns.size(), 0.25);
  }
  Bytes payload = patterns::encode(
      {values.data(), filled.data(), kept.data(), segments, projections, max_error, max_error},
      frames, plan);
  std::vector<double> decoded(values.size());
  patterns::decode(payload, decoded.data(), frames, plan);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && !(std::fabs(values[i] - decoded[i]) <= max_error)) std::abort();
  }
  if (payload.empty()) return;
  payload[input.below(256) % payload.size()] ^= static_cast<std::uint8_t>(1 + input.below(255));
  done([&] { patterns::decode(payload, decoded.data(), frames, plan); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const bool encodes = input.below(2) != 0;
  const std::size_t frames = input.below(60), columns = 1 + input.below(9);
  done([&] {
    if (encodes) {
      const auto plan = patterns::read_plan(header_of(input, columns), {}, columns);
      round_trip(input, plan, frames, columns);
      return;
    }
    const Bytes header = taken(input, input.below(120)), model = taken(input, input.below(160));
    const auto plan = patterns::read_plan(header, model, columns);
    std::vector<double> values(frames * columns);
    patterns::decode(input.rest(), values.data(), frames, plan);
  });
  return 0;
}
