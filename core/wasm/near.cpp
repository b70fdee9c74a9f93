#include "near/codec.hpp"
#include "wasm/decoder.hpp"

namespace mocapress::wasm {

// No parameters.
void decode(const Request& request, double* values) {
  const auto plan = near::read_header(request.header, request.columns);
  near::decode(request.payload, values, request.frames, plan);
}

}  // namespace mocapress::wasm
