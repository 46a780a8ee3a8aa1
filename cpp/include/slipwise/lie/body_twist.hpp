// SPDX-License-Identifier: Apache-2.0
// The body twist of a planar robot.
#pragma once

namespace slipwise {

/// Velocity of the robot in its own frame (REP-103: x forward, y left, counter-clockwise).
struct BodyTwist {
  double v = 0.0;      ///< forward [m/s]
  double vy = 0.0;     ///< to the left [m/s]; zero but for omnidirectional drives
  double omega = 0.0;  ///< yaw rate [rad/s]

  bool operator==(const BodyTwist&) const = default;
};

/// A car that stands has a twist of this speed, so that its yaw rate over it still says how the wheels are turned
/// [m/s].
inline constexpr double kStandingSpeed = 1e-9;

}  // namespace slipwise
