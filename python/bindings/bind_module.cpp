// SPDX-License-Identifier: Apache-2.0
// The extension module slipwise._core: all of slipwise's mathematics.
#include "bindings.hpp"

NB_MODULE(_core, m) {
  using namespace slipwise::bindings;
  // Objects in tracebacks and caches outlive the module at exit; nanobind would call that a leak on the user's
  // terminal.
  nanobind::set_leak_warnings(false);
  m.doc() = "The mathematics of slipwise: lie, vehicle, slip, actuator, motion, segment, rollout, planning, estimate.";
  bind_lie(m);
  bind_vehicle(m);
  bind_slip(m);
  bind_actuator(m);
  bind_car(m);
  bind_motion(m);
  bind_segment(m);
  bind_rollout(m);
  bind_planning(m);
  bind_estimate(m);
  bind_slip_disturbance(m);
  bind_smoother(m);
  bind_actuator_filter(m);
  bind_dynamics(m);
  bind_limits(m);
  bind_archive(m);
  bind_terrain(m);
  bind_surfaces(m);
  bind_online(m);
}
