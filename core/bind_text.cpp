#include "bindings.hpp"

namespace mocapress {

void bind_text(nanobind::module_& module) { (void)module; }

}  // namespace mocapress
