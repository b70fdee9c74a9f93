#include "bindings.hpp"

namespace mocapress {

void bind_app(nanobind::module_& module) { (void)module; }

}  // namespace mocapress
