// The extension module mocapress._core.
#include "python/bindings.hpp"

NB_MODULE(_core, module) {
  module.doc() = "The compiled kernels; arrays are C-contiguous.";
  mocapress::bind_c3d(module);
  mocapress::bind_formats(module);
  mocapress::bind_motion(module);
  mocapress::bind_record(module);
  mocapress::bind_rows(module);
  mocapress::bind_table(module);
  mocapress::bind_app(module);
  mocapress::bind_exact(module);
  mocapress::bind_diffma(module);
  mocapress::bind_mrpa(module);
  mocapress::bind_near(module);
  mocapress::bind_patterns(module);
  mocapress::bind_qssd(module);
  mocapress::bind_qssd_learning(module);
  mocapress::bind_search(module);
}
