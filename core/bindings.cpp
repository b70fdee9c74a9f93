// The extension module mocapress._core.
#include "bindings.hpp"

NB_MODULE(_core, module) {
  mocapress::bind_text(module);
  mocapress::bind_app(module);
  mocapress::bind_exact(module);
  mocapress::bind_diffma(module);
}
