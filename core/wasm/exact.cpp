#include "coding/fail.hpp"
#include "exact/header.hpp"
#include "wasm/decoder.hpp"

namespace mocapress::wasm {

// Parameters: level, chunk.
void decode(const Request& request, double* values) {
  const auto header = exact::read_header(request.header, request.columns);
  if (header.has_model && request.model.empty()) fail("the clip was coded with a model");
  const auto start =
      request.model.empty() ? exact::Start{} : exact::read_start(request.model, header);
  exact::decode(request.payload, values, request.frames, request.frames, request.columns, header,
                static_cast<int>(request.parameters[0]), start);
}

}  // namespace mocapress::wasm
