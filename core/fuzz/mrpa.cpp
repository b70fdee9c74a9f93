// MRPA's decoder on any bytes; its encoder on any values beside any parents, whose payload must
// decode to them; the decoder on such a payload with one byte changed; and path growing and
// segmentation on anything.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "fuzz/input.hpp"
#include "mrpa/codec.hpp"
#include "mrpa/header.hpp"
#include "mrpa/paths.hpp"
#include "mrpa/segments.hpp"

namespace app = mocapress::app;
namespace mrpa = mocapress::mrpa;
using mocapress::Bytes;
using mocapress::ByteView;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;
using mocapress::fuzz::same_bits;

namespace {

void analyse(Input& input) {
  const std::size_t frames = input.below(40);
  std::vector<std::int64_t> starts{0};
  std::vector<std::int32_t> matches, clips(frames);
  std::vector<float> distances;
  for (std::size_t t = 0; t < frames; ++t) {
    clips[t] = static_cast<std::int32_t>(input.below(2));
    for (unsigned n = input.below(6); n > 0; --n) {
      matches.push_back(static_cast<std::int32_t>(input.below(48)) - 4);
      distances.push_back(static_cast<float>(input.below(9)));
    }
    starts.push_back(static_cast<std::int64_t>(matches.size()));
  }
  done([&] {
    mrpa::grow({starts, matches, distances, clips}, static_cast<std::int32_t>(input.below(5)),
               input.below(2) != 0 ? mrpa::Keep::deepest : mrpa::Keep::nearest);
  });
  std::vector<mrpa::Segment> inputs(input.below(6));
  for (auto& [first, last] : inputs) {
    first = static_cast<std::int64_t>(input.below(48)) - 4;
    last = static_cast<std::int64_t>(input.below(48)) - 4;
  }
  const std::vector<double> rates{0.5, 0.25};
  done([&] {
    mrpa::refined(inputs, static_cast<std::int64_t>(frames),
                  static_cast<std::int64_t>(input.below(20)), rates);
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const unsigned what = input.below(3);
  if (what == 2) {
    analyse(input);
    return 0;
  }
  std::vector<mrpa::Piece> pieces(input.below(4));
  std::size_t frames = 0;
  for (auto& piece : pieces) {
    piece = {input.below(24), input.below(2) != 0, input.below(2) != 0};
    frames += piece.frames;
  }
  std::vector<app::Column> columns(input.below(9));
  const int limit = 1 + static_cast<int>(input.below(53));
  for (auto& column : columns) {
    column.parent = static_cast<std::int32_t>(&column - columns.data()) - 1;
    column.precision = static_cast<app::Precision>(input.below(3));
    const auto line = static_cast<int>(input.below(7));
    column.digits = static_cast<int>(input.below(30)) - 2;
    const bool exists = mocapress::line_exists(line, column.digits);
    column.line = exists ? static_cast<mocapress::Line>(line) : mocapress::Line::float64;
  }
  const std::size_t count = frames * columns.size();
  std::vector<double> parents = Input(input).numbers(count);
  parents.resize(count);
  std::vector<double> decoded(count);
  const auto decodes = [&](ByteView payload) {
    return done(
        [&] { mrpa::decode(payload, decoded.data(), parents.data(), pieces, columns, limit); });
  };
  if (what == 0) {
    done([&] { mrpa::decode_alone(input.rest(), decoded.data(), frames, columns, limit); });
    decodes(input.rest());
    return 0;
  }

  std::vector<double> values = Input(input).numbers(count);
  values.resize(count);
  const auto precisions = app::precisions(values.data(), frames, columns);
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c].precision = precisions[c];
  Bytes payload = mrpa::encode({values.data(), parents.data(), pieces, columns}, limit,
                               static_cast<mrpa::Choice>(input.below(3)));
  if (!decodes(payload)) std::abort();
  if (!same_bits(values, decoded)) std::abort();
  payload[input.below(256) % payload.size()] ^= static_cast<std::uint8_t>(1 + input.below(255));
  decodes(payload);
  return 0;
}
