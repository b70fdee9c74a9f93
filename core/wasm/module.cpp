#include "wasm/module.hpp"

#include <cstdint>
#include <vector>

#include "coding/fail.hpp"

namespace {

std::vector<double> space;   // doubles, so that parameters can stand at its front
std::vector<double> values;  // what the last chunk holds

}  // namespace

extern "C" {

// Where a request of so many bytes is to be written; good until the next call.
[[clang::export_name("space")]] void* mocapress_space(std::size_t size) {
  space.resize(size / sizeof(double) + 1);
  return space.data();
}

// Decodes the request that stands in the space: parameters, formats (two bytes a column), header,
// model and payload, one behind the other, of these sizes.
[[clang::export_name("decode")]] const double* mocapress_decode(
    std::size_t columns, std::size_t frames, std::size_t parameters, std::size_t header,
    std::size_t model, std::size_t payload) {
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

}  // extern "C"
