// SPDX-License-Identifier: Apache-2.0
// The extension module slipwise_thesis._thesis. Its functions take and return types of slipwise._core.
#include "thesis_bindings.hpp"

NB_MODULE(_thesis, m) {
  using namespace slipwise::bindings;
  // Objects in tracebacks and caches outlive the module at exit; nanobind would call that a leak on the user's
  // terminal.
  nanobind::set_leak_warnings(false);
  m.doc() = "The estimators, observers and regressions of the thesis that slipwise comes from.";
  nanobind::module_::import_("slipwise._core");  // registers the types
  bind_estimators(m);
  bind_regression(m);
  bind_slip_ratios(m);
  bind_steady(m);
}
