#include "wasm/decoder.hpp"

#include <cstdint>
#include <vector>

#include "wasm/space.hpp"

// Decodes the request that stands in the space: parameters, formats (two bytes a column), header,
// model and payload, one behind the other, of these sizes. What it gives is good until the next
// call.
extern "C" [[clang::export_name("decode")]] const double* mocapress_decode(
    std::size_t columns, std::size_t frames, std::size_t parameters, std::size_t header,
    std::size_t model, std::size_t payload) {
  static std::vector<double> values;
  const auto& space = mocapress::wasm::space();
  const auto* next = reinterpret_cast<const std::uint8_t*>(space.data() + parameters);
  const auto taken = [&next](std::size_t size) {
    const mocapress::ByteView bytes(next, size);
    next += size;
    return bytes;
  };
  const mocapress::ByteView formats = taken(2 * columns), own = taken(header),
                            learned = taken(model), coded = taken(payload);
  values.resize(columns * frames);
  mocapress::wasm::decode(
      {columns, frames, {space.data(), parameters}, formats, own, learned, coded}, values.data());
  return values.data();
}
