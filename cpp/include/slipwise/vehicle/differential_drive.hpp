// SPDX-License-Identifier: Apache-2.0
// Differential and skid-steer drives: body twist from wheel speeds (thesis 2.2, with wheel_separation = 2c).
#pragma once

#include <stdexcept>

#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

struct WheelSpeeds {
  double left = 0.0;   ///< [rad/s]
  double right = 0.0;  ///< [rad/s]
};

/// A vehicle steered by the difference of its side speeds.
struct DifferentialDrive {
  double wheel_radius;      ///< [m]
  double wheel_separation;  ///< distance between the left and the right wheels [m]

  /// \throws std::invalid_argument when a dimension is not positive.
  DifferentialDrive(double wheel_radius_m, double wheel_separation_m)
      : wheel_radius(wheel_radius_m), wheel_separation(wheel_separation_m) {
    if (!(wheel_radius > 0.0) || !(wheel_separation > 0.0)) {
      throw std::invalid_argument(
          "wheel radius and separation must be positive [m]; measure them or take the maker's figures");
    }
  }

  BodyTwist twist(const WheelSpeeds& wheels) const {
    return {.v = wheel_radius * (wheels.left + wheels.right) / 2.0,
            .vy = 0.0,
            .omega = wheel_radius * (wheels.right - wheels.left) / wheel_separation};
  }
};

}  // namespace slipwise
