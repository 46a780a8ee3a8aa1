// SPDX-License-Identifier: Apache-2.0
// What a robot may be commanded to do, and the state in which a plan begins.
#pragma once

#include <optional>

#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// Limits of the commands, not of what the robot makes of them.
struct DriveLimits {
  double speed = 1.0;         ///< [m/s], forwards and backwards
  double yaw_rate = 1.0;      ///< [rad/s], to both sides
  double curvature = 1.0;     ///< |yaw rate / speed| [1/m]
  double acceleration = 0.5;  ///< of the speed, also when braking [m/s^2]

  /// \throws std::invalid_argument unless all are positive and finite.
  void check() const;
};

/// The robot when a plan begins.
struct ActuatorState {
  BodyTwist drive = {};                ///< what the drive does, behind its lag
  BodyTwist commanded = {};            ///< the last command before the plan; it acts until the delay is over
  std::optional<BodyTwist> fast = {};  ///< of the drive, what the lags hold beside the slow ones; settled if not known

  /// \throws std::invalid_argument unless all are finite.
  void check() const;
};

}  // namespace slipwise
