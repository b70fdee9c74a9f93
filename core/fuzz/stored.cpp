// What the page's decoders do with any codec header and chunk: as a file has them, without Python's
// checks before.
#include "diffma/stored.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/header.hpp"
#include "exact/header.hpp"
#include "fuzz/input.hpp"

namespace app = mocapress::app;
namespace diffma = mocapress::diffma;
namespace exact = mocapress::exact;
using mocapress::ByteView;
using mocapress::NumberFormat;
using mocapress::NumberKind;
using mocapress::fuzz::done;
using mocapress::fuzz::Input;

namespace {

constexpr unsigned kSkeleton = 62;  // columns, of which the known skeleton has as many

void decode_exact(ByteView header, ByteView rest, int level, std::vector<double>& values,
                  std::size_t frames, std::size_t columns) {
  const auto told = exact::read_header(header, columns);
  const std::size_t model = rest.size() / 4;
  const auto start = told.has_model ? exact::read_start(rest.first(model), told) : exact::Start{};
  exact::decode(told.has_model ? rest.subspan(model) : rest, values.data(), frames, frames, columns,
                told, level, start);
}

void decode_app(ByteView header, ByteView payload, const std::vector<NumberFormat>& formats,
                std::vector<double>& values, std::size_t frames) {
  static constexpr double kAlphas[] = {-1, -0.5, -0.25, 0, 0.25, 0.5, 1, 2};
  const auto columns = app::read_header(header, formats);
  app::decode(payload, values.data(), frames, columns, {kAlphas, 15, 12});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  const unsigned codec = input.below(3);
  const std::size_t columns = input.below(4) == 0 ? kSkeleton : input.below(32);
  const std::size_t frames = 1 + input.below(96);
  const int level = 1 + static_cast<int>(input.below(9));
  const unsigned told = input.below(256);
  std::vector<NumberFormat> formats(columns);
  for (auto& format : formats) {
    format.kind = static_cast<NumberKind>(level % 6);
    format.digits = static_cast<std::uint8_t>(told % 24);
  }
  const ByteView rest = input.rest();
  const ByteView header = rest.first(std::min<std::size_t>(told, rest.size()));
  const ByteView payload = rest.subspan(header.size());
  std::vector<double> values(frames * columns);
  done([&] {
    if (codec == 0) decode_exact(header, payload, level, values, frames, columns);
    if (codec == 1) decode_app(header, payload, formats, values, frames);
    if (codec == 2) {
      const std::string_view text(reinterpret_cast<const char*>(payload.data()), payload.size());
      diffma::decode_stored(header, text, 1 + level, 8, values.data(), frames, columns);
    }
  });
  return 0;
}
