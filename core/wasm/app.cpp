#include "app/header.hpp"
#include "coding/fail.hpp"
#include "wasm/decoder.hpp"

namespace mocapress::wasm {

// Parameters: t, mantissa_limit, the alphas of the table.
void decode(const Request& request, double* values) {
  std::vector<NumberFormat> formats(request.columns);
  for (std::size_t c = 0; c < formats.size(); ++c) {
    formats[c].kind = static_cast<NumberKind>(request.formats[2 * c]);
    formats[c].digits = request.formats[2 * c + 1];
  }
  const auto columns = app::read_header(request.header, formats);
  const app::Parameters parameters{request.parameters.subspan(2),
                                   static_cast<std::size_t>(request.parameters[0]),
                                   static_cast<int>(request.parameters[1])};
  app::decode(request.payload, values, request.frames, columns, parameters);
}

}  // namespace mocapress::wasm
