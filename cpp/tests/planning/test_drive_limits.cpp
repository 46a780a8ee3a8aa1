// SPDX-License-Identifier: Apache-2.0
// Limits and starts that make no sense are refused, with the name of what is wrong.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>

#include "slipwise/planning/drive_limits.hpp"

namespace slipwise {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();

std::string refusal(const DriveLimits& limits) {
  try {
    limits.check();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("the limit that is no positive number is named") {
  CHECK(refusal({}).empty());
  for (const double wrong : {0.0, -1.0, kNan, kEndless}) {
    CHECK(refusal({.speed = wrong}).find("limit of speed") != std::string::npos);
    CHECK(refusal({.yaw_rate = wrong}).find("limit of yaw rate") != std::string::npos);
    CHECK(refusal({.curvature = wrong}).find("limit of curvature") != std::string::npos);
    CHECK(refusal({.acceleration = wrong}).find("limit of acceleration") != std::string::npos);
  }
}

TEST_CASE("a start whose drive, command or fast mode is not finite is refused") {
  CHECK_NOTHROW(ActuatorState{}.check());
  CHECK_NOTHROW(ActuatorState{.drive = {.v = -2.0}, .commanded = {.v = 1.0}, .fast = BodyTwist{.v = 0.1}}.check());
  CHECK_THROWS_AS(ActuatorState{.drive = {.v = kNan}}.check(), std::invalid_argument);
  CHECK_THROWS_AS(ActuatorState{.commanded = {.omega = kEndless}}.check(), std::invalid_argument);
  CHECK_THROWS_AS(ActuatorState{.fast = BodyTwist{.vy = kNan}}.check(), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
