// SPDX-License-Identifier: Apache-2.0
// One function per C++ folder registers its types and functions with the extension module.
#pragma once

#include <nanobind/nanobind.h>

namespace slipwise::bindings {

void bind_lie(nanobind::module_& m);
void bind_vehicle(nanobind::module_& m);
void bind_slip(nanobind::module_& m);
void bind_actuator(nanobind::module_& m);
void bind_motion(nanobind::module_& m);
void bind_segment(nanobind::module_& m);
void bind_planning(nanobind::module_& m);
void bind_rollout(nanobind::module_& m);
void bind_estimate(nanobind::module_& m);
void bind_coloured_slip(nanobind::module_& m);
void bind_limits(nanobind::module_& m);
void bind_regression(nanobind::module_& m);
void bind_estimators(nanobind::module_& m);
void bind_online(nanobind::module_& m);

}  // namespace slipwise::bindings
