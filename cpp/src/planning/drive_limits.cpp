// SPDX-License-Identifier: Apache-2.0
// Checks of limits and of the state in which a plan begins.
#include "slipwise/planning/drive_limits.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace slipwise {
namespace {

void need_positive(const char* name, double value) {
  if (!std::isfinite(value) || value <= 0.0) {
    throw std::invalid_argument("the limit of " + std::string(name) + " is " + std::to_string(value) +
                                "; give a positive number");
  }
}

}  // namespace

void DriveLimits::check() const {
  need_positive("speed", speed);
  need_positive("yaw rate", yaw_rate);
  need_positive("curvature", curvature);
  need_positive("acceleration", acceleration);
}

void ActuatorState::check() const {
  for (const BodyTwist& twist : {drive, commanded, fast.value_or(BodyTwist{})}) {
    if (!std::isfinite(twist.v) || !std::isfinite(twist.vy) || !std::isfinite(twist.omega)) {
      throw std::invalid_argument("the twist at the start is not finite; give what the robot does and was commanded");
    }
  }
}

}  // namespace slipwise
