#include "patterns/codec.hpp"
#include "wasm/decoder.hpp"

namespace mocapress::wasm {

// No parameters: all that decoding needs is in the header.
void decode(const Request& request, double* values) {
  const auto plan = patterns::read_plan(request.header, request.model, request.columns);
  patterns::decode(request.payload, values, request.frames, plan);
}

}  // namespace mocapress::wasm
