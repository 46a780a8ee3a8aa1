// SPDX-License-Identifier: Apache-2.0
// Wheel speeds to body twist.
#include <doctest/doctest.h>

#include <stdexcept>

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

TEST_CASE("dimensions that are not positive are refused") {
  CHECK_THROWS_AS(DifferentialDrive(0.0, 1.0), std::invalid_argument);
  CHECK_THROWS_AS(DifferentialDrive(0.2, -1.0), std::invalid_argument);
  CHECK_THROWS_WITH_AS(DifferentialDrive(0.2, 0.0), doctest::Contains("must be positive"), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
