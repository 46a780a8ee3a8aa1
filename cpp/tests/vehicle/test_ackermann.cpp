// SPDX-License-Identifier: Apache-2.0
// Speed and steering angle to body twist.
#include <doctest/doctest.h>

#include <numbers>
#include <stdexcept>

#include "slipwise/vehicle/ackermann.hpp"

namespace slipwise {
namespace {

const Ackermann kCar(2.5);

TEST_CASE("straight wheels drive straight") { CHECK(kCar.twist(3.0, 0.0).omega == 0.0); }

TEST_CASE("wheels to the left turn to the left, and backwards to the right") {
  CHECK(kCar.twist(2.0, std::numbers::pi / 4.0).omega == doctest::Approx(2.0 / 2.5));
  CHECK(kCar.twist(-2.0, std::numbers::pi / 4.0).omega == doctest::Approx(-2.0 / 2.5));
}

TEST_CASE("a wheelbase that is not positive is refused") {
  CHECK_THROWS_WITH_AS(Ackermann(0.0), doctest::Contains("must be positive"), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
