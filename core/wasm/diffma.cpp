#include "diffma/stored.hpp"
#include "wasm/decoder.hpp"

namespace mocapress::wasm {

// Parameters: bits, window. The payload is unpacked.
void decode(const Request& request, double* values) {
  const auto* text = reinterpret_cast<const char*>(request.payload.data());
  diffma::decode_stored(
      request.header, {text, request.payload.size()}, static_cast<int>(request.parameters[0]),
      static_cast<std::size_t>(request.parameters[1]), values, request.frames, request.columns);
}

}  // namespace mocapress::wasm
