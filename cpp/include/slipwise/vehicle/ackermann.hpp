// SPDX-License-Identifier: Apache-2.0
// Cars with steered front wheels: body twist of the rear axle from speed and steering angle (the bicycle model).
#pragma once

#include <cmath>
#include <stdexcept>

#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// The robot's frame is at the middle of the rear axle.
struct Ackermann {
  double wheelbase;  ///< distance between the axles [m]

  /// \throws std::invalid_argument when the wheelbase is not positive.
  explicit Ackermann(double wheelbase_m) : wheelbase(wheelbase_m) {
    if (!(wheelbase > 0.0)) {
      throw std::invalid_argument("the wheelbase must be positive [m]; measure from axle to axle");
    }
  }

  /// `v` [m/s] at the rear axle, `steer` [rad] of the middle of the front axle, to the left. Standing with turned
  /// wheels it creeps by kStandingSpeed, so that the twist says how these are turned.
  BodyTwist twist(double v, double steer) const {
    const double known = v == 0.0 && steer != 0.0 ? kStandingSpeed : v;
    return {.v = known, .vy = 0.0, .omega = known * std::tan(steer) / wheelbase};
  }
};

}  // namespace slipwise
