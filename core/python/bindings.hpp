// Every kernel binds its own functions; python/module.cpp calls them all.
#pragma once

#include <nanobind/nanobind.h>

namespace mocapress {

void bind_rows(nanobind::module_& module);
void bind_app(nanobind::module_& module);
void bind_exact(nanobind::module_& module);
void bind_diffma(nanobind::module_& module);

}  // namespace mocapress
