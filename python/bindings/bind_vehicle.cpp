// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/vehicle.
#include "bindings.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/vehicle/differential_drive.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {

void bind_vehicle(nb::module_& m) {
  nb::class_<BodyTwist>(m, "BodyTwist", "Body velocity (v [m/s], vy [m/s], omega [rad/s]).")
      .def(nb::init<double, double, double>(), "v"_a, "vy"_a, "omega"_a)
      .def_ro("v", &BodyTwist::v)
      .def_ro("vy", &BodyTwist::vy)
      .def_ro("omega", &BodyTwist::omega);
  nb::class_<DifferentialDrive>(m, "DifferentialDrive", "Differential or skid-steer drive (thesis 2.2).")
      .def(nb::init<double, double>(), "wheel_radius"_a, "track"_a)
      .def_ro("wheel_radius", &DifferentialDrive::wheel_radius)
      .def_ro("track", &DifferentialDrive::track)
      .def(
          "twist", [](const DifferentialDrive& d, double left, double right) { return d.twist({left, right}); },
          "left"_a, "right"_a, "Body twist from wheel speeds [rad/s].");
}

}  // namespace slipwise::bindings
