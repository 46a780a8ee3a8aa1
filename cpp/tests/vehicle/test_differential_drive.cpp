// SPDX-License-Identifier: Apache-2.0
// Wheel speeds to body twist and back.
#include <doctest/doctest.h>

#include <stdexcept>

#include "finite_difference.hpp"
#include "slipwise/vehicle/differential_drive.hpp"

namespace slipwise {
namespace {

const DifferentialDrive kDrive(0.25, 1.2);

TEST_CASE("equal wheel speeds drive straight") {
  const BodyTwist twist = kDrive.twist({4.0, 4.0});
  CHECK(twist.v == doctest::Approx(1.0));
  CHECK(twist.vy == 0.0);
  CHECK(twist.omega == 0.0);
}

TEST_CASE("a faster right side turns to the left") {
  const BodyTwist twist = kDrive.twist({-2.4, 2.4});
  CHECK(twist.v == 0.0);
  CHECK(twist.omega == doctest::Approx(1.0));
}

TEST_CASE("wheel speeds and twist undo each other") {
  const WheelSpeeds wheels = kDrive.wheel_speeds(kDrive.twist({3.0, -1.7}));
  CHECK(wheels.left == doctest::Approx(3.0).epsilon(1e-14));
  CHECK(wheels.right == doctest::Approx(-1.7).epsilon(1e-14));
}

TEST_CASE("the drive's Jacobian is the derivative of its twist") {
  const auto twist = [](const Eigen::VectorXd& wheels) -> Eigen::VectorXd {
    const BodyTwist body = kDrive.twist({wheels[0], wheels[1]});
    return Eigen::Vector2d(body.v, body.omega);
  };
  const auto numeric = tests::finite_difference(twist, Eigen::Vector2d(1.0, -2.0), 0.1);
  CHECK(tests::jacobian_error(kDrive.twist_jacobian(), numeric) < tests::kDerivativeTolerance);
}

TEST_CASE("dimensions that are not positive are refused") {
  CHECK_THROWS_AS(DifferentialDrive(0.0, 1.0), std::invalid_argument);
  CHECK_THROWS_AS(DifferentialDrive(0.2, -1.0), std::invalid_argument);
  CHECK_THROWS_WITH_AS(DifferentialDrive(0.2, 0.0), doctest::Contains("must be positive"), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
