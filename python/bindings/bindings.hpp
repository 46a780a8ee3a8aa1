// SPDX-License-Identifier: Apache-2.0
// One function per C++ folder registers its types and functions with the extension module.
#pragma once

#include <nanobind/nanobind.h>

#include <string_view>

namespace slipwise::bindings {

void bind_lie(nanobind::module_& m);
void bind_vehicle(nanobind::module_& m);
void bind_slip(nanobind::module_& m);
void bind_actuator(nanobind::module_& m);
void bind_car(nanobind::module_& m);
void bind_motion(nanobind::module_& m);
void bind_segment(nanobind::module_& m);
void bind_planning(nanobind::module_& m);
void bind_rollout(nanobind::module_& m);
void bind_estimate(nanobind::module_& m);
void bind_slip_disturbance(nanobind::module_& m);
void bind_limits(nanobind::module_& m);
void bind_smoother(nanobind::module_& m);
void bind_actuator_filter(nanobind::module_& m);
void bind_archive(nanobind::module_& m);
void bind_terrain(nanobind::module_& m);
void bind_surfaces(nanobind::module_& m);
void bind_dynamics(nanobind::module_& m);
void bind_recordings(nanobind::module_& m);
void bind_evidence(nanobind::module_& m);
void bind_sources(nanobind::module_& m);
void bind_online(nanobind::module_& m);

inline std::string_view view_of(const nanobind::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }
inline nanobind::bytes bytes_of(std::string_view text) { return nanobind::bytes(text.data(), text.size()); }

}  // namespace slipwise::bindings
