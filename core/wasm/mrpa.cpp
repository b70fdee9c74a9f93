#include "coding/fail.hpp"
#include "mrpa/header.hpp"
#include "wasm/decoder.hpp"

namespace mocapress::wasm {

// Parameter: mantissa_limit. A clip of its own has no parents.
void decode(const Request& request, double* values) {
  std::vector<NumberFormat> formats(request.columns);
  for (std::size_t c = 0; c < formats.size(); ++c) {
    formats[c].kind = static_cast<NumberKind>(request.formats[2 * c]);
    formats[c].digits = request.formats[2 * c + 1];
  }
  const auto columns = mrpa::read_header(request.header, formats);
  mrpa::decode_alone(request.payload, values, request.frames, columns,
                     static_cast<int>(request.parameters[0]));
}

}  // namespace mocapress::wasm
