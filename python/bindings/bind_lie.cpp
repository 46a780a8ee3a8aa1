// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/lie.
#include <nanobind/eigen/dense.h>

#include "bindings.hpp"
#include "slipwise/lie/se2.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_lie(nb::module_& m) {
  nb::class_<Pose2>(m, "Pose2", "A planar pose (x [m], y [m], theta [rad], unwrapped).")
      .def(nb::init<double, double, double>(), "x"_a, "y"_a, "theta"_a)
      .def_ro("x", &Pose2::x)
      .def_ro("y", &Pose2::y)
      .def_ro("theta", &Pose2::theta)
      .def("vector", &Pose2::vector);
  m.def("wrap_angle", &wrap_angle, "angle"_a, "The angle in (-pi, pi] [rad].");
  m.def("exp", &exp, "tangent"_a, "The pose reached by a constant twist, tangent = twist * time.");
  m.def("log", &log, "pose"_a, "The tangent of a pose, turning by at most half a turn.");
  m.def("compose", &compose, "a_b"_a, "b_c"_a, "T_a_c = T_a_b T_b_c.");
  m.def("inverse", &inverse, "pose"_a);
  m.def("between", &between, "world_a"_a, "world_b"_a, "T_a_b from T_w_a and T_w_b.");
}

}  // namespace slipwise::bindings
