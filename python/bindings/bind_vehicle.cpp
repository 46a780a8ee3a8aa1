// SPDX-License-Identifier: Apache-2.0
// Bindings of cpp/include/slipwise/vehicle.
#include <nanobind/eigen/dense.h>

#include "bindings.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/vehicle/ackermann.hpp"
#include "slipwise/vehicle/differential_drive.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace slipwise::bindings {
namespace {

/// (v, omega) per row from two columns of what a drive measures.
template <typename TwistOfPair>
Eigen::MatrixX2d twist_rows(const Eigen::VectorXd& first, const Eigen::VectorXd& second, TwistOfPair twist_of) {
  if (first.size() != second.size()) {
    throw std::invalid_argument("the two columns must have equal lengths");
  }
  Eigen::MatrixX2d rows(first.size(), 2);
  for (Eigen::Index i = 0; i < first.size(); ++i) {
    const BodyTwist twist = twist_of(first[i], second[i]);
    rows.row(i) << twist.v, twist.omega;
  }
  return rows;
}

}  // namespace

void bind_vehicle(nb::module_& m) {
  nb::class_<BodyTwist>(m, "BodyTwist", "Body velocity (v [m/s], vy [m/s], omega [rad/s]).")
      .def(nb::init<double, double, double>(), "v"_a, "vy"_a, "omega"_a)
      .def_ro("v", &BodyTwist::v)
      .def_ro("vy", &BodyTwist::vy)
      .def_ro("omega", &BodyTwist::omega);
  nb::class_<DifferentialDrive>(m, "DifferentialDrive", "Differential or skid-steer drive (thesis 2.2).")
      .def(nb::init<double, double>(), "wheel_radius"_a, "wheel_separation"_a)
      .def_ro("wheel_radius", &DifferentialDrive::wheel_radius)
      .def_ro("wheel_separation", &DifferentialDrive::wheel_separation)
      .def(
          "twists",
          [](const DifferentialDrive& d, const Eigen::VectorXd& left, const Eigen::VectorXd& right) {
            return twist_rows(left, right, [&d](double l, double r) { return d.twist({l, r}); });
          },
          "left"_a, "right"_a, "Rows of (v [m/s], omega [rad/s]) from wheel speeds [N] in rad/s.");
  nb::class_<Ackermann>(m, "Ackermann", "A car with steered front wheels, seen at its rear axle.")
      .def(nb::init<double>(), "wheelbase"_a)
      .def_ro("wheelbase", &Ackermann::wheelbase)
      .def(
          "twists",
          [](const Ackermann& car, const Eigen::VectorXd& v, const Eigen::VectorXd& steer) {
            return twist_rows(v, steer, [&car](double speed, double angle) { return car.twist(speed, angle); });
          },
          "v"_a, "steer"_a, "Rows of (v [m/s], omega [rad/s]) from speeds [N] in m/s and steering angles [N] in rad.");
}

}  // namespace slipwise::bindings
