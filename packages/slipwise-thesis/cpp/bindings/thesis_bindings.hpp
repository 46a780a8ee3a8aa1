// SPDX-License-Identifier: Apache-2.0
// One function per file registers its types and functions with the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace slipwise::bindings {

void bind_estimators(nanobind::module_& m);
void bind_regression(nanobind::module_& m);
void bind_slip_ratios(nanobind::module_& m);
void bind_steady(nanobind::module_& m);

}  // namespace slipwise::bindings
