// SPDX-License-Identifier: Apache-2.0
// Slip ratios: the kinematics of (2.5) to (2.7) with corrected signs, and the same slip as terms of full-linear-6.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "finite_difference.hpp"
#include "slipwise/slip/slip_surface.hpp"
#include "slipwise/thesis/slip_ratios.hpp"
#include "slipwise/vehicle/differential_drive.hpp"

namespace slipwise {
namespace {

const DifferentialDrive kDrive(0.25, 1.2);
const SlipRatios kSlip{.left = 0.15, .right = -0.08, .angle = 0.12};

std::vector<WheelSpeeds> sample_wheels() { return {{4.0, 6.0}, {5.0, 5.0}, {-3.0, 3.0}, {-6.0, -2.0}, {0.0, 4.0}}; }

TEST_CASE("each side moves over the terrain at its rim speed less its slip") {
  for (const WheelSpeeds& wheels : sample_wheels()) {
    const BodyTwist twist = slipping_twist(kDrive.twist(wheels), kSlip, kDrive.wheel_separation);
    const double c = kDrive.wheel_separation / 2.0;
    CHECK(twist.v - c * twist.omega == doctest::Approx(kDrive.wheel_radius * wheels.left * (1.0 - kSlip.left)));
    CHECK(twist.v + c * twist.omega == doctest::Approx(kDrive.wheel_radius * wheels.right * (1.0 - kSlip.right)));
  }
}

TEST_CASE("the yaw rate is that of thesis 2.7 with its sign turned round, from either side") {
  const double c = kDrive.wheel_separation / 2.0;
  for (const WheelSpeeds& wheels : sample_wheels()) {
    const BodyTwist twist = slipping_twist(kDrive.twist(wheels), kSlip, kDrive.wheel_separation);
    const double from_right = -twist.v / c + kDrive.wheel_radius * wheels.right * (1.0 - kSlip.right) / c;
    const double from_left = twist.v / c - kDrive.wheel_radius * wheels.left * (1.0 - kSlip.left) / c;
    CHECK(twist.omega == doctest::Approx(from_right).epsilon(1e-12));
    CHECK(twist.omega == doctest::Approx(from_left).epsilon(1e-12));
  }
}

TEST_CASE("the velocity in the world is that of thesis 2.5 and the corrected 2.6") {
  const double theta = 0.7;
  const BodyTwist twist = slipping_twist(kDrive.twist({4.0, 6.0}), kSlip, kDrive.wheel_separation);
  const double c = std::cos(theta), s = std::sin(theta), tangent = std::tan(kSlip.angle);
  CHECK(c * twist.v - s * twist.vy == doctest::Approx(twist.v * (c + s * tangent)));
  CHECK(s * twist.v + c * twist.vy == doctest::Approx(twist.v * (s - c * tangent)));
  CHECK(twist.vy < 0.0);  // a positive slip angle is a drift to the right
}

TEST_CASE("a left side that spins turns the robot to the left") {
  const BodyTwist twist = slipping_twist(kDrive.twist({5.0, 5.0}), {.left = 0.2}, kDrive.wheel_separation);
  CHECK(twist.omega > 0.0);
  CHECK(twist.v < 1.25);
}

TEST_CASE("slip ratios are six linear terms") {
  const Basis basis = named_basis("full-linear-6");
  const LinearSlip linear = linear_slip(kSlip, kDrive.wheel_separation);
  for (const WheelSpeeds& wheels : sample_wheels()) {
    const BodyTwist ideal = kDrive.twist(wheels);
    const BodyTwist twist = slipping_twist(ideal, kSlip, kDrive.wheel_separation);
    const Eigen::Vector3d slip = slip_rate(basis, linear.alpha, {.v = ideal.v, .omega = ideal.omega});
    CHECK(ideal.v + slip[0] == doctest::Approx(twist.v).epsilon(1e-12));
    CHECK(slip[1] == doctest::Approx(twist.vy).epsilon(1e-12));
    CHECK(ideal.omega + slip[2] == doctest::Approx(twist.omega).epsilon(1e-12));
  }
}

TEST_CASE("the linear terms have the derivative that is stated") {
  const auto terms = [](const Eigen::VectorXd& slip) -> Eigen::VectorXd {
    return linear_slip(SlipRatios::from_vector(slip), 1.2).alpha;
  };
  const auto numeric = tests::finite_difference(terms, kSlip.vector(), 0.1);
  CHECK(tests::jacobian_error(linear_slip(kSlip, 1.2).by_slip_ratios, numeric) < tests::kDerivativeTolerance);
}

TEST_CASE("impossible slip is brought back to the nearest possible one") {
  const SlipRatios far = bounded({.left = 3.0, .right = -2.0, .angle = 1.5});
  CHECK(far.vector() == Eigen::Vector3d(kLargestSlipRatio, -kLargestSlipRatio, kLargestSlipAngle));
  CHECK(bounded(kSlip).vector() == kSlip.vector());
}

}  // namespace
}  // namespace slipwise
