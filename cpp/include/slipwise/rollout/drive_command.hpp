// SPDX-License-Identifier: Apache-2.0
// What a robot is commanded to drive.
#pragma once

namespace slipwise {

/// Of a car that is commanded by throttle and steering in [-1, 1], these are v and omega.
struct DriveCommand {
  double v = 0.0;      ///< speed [m/s]
  double omega = 0.0;  ///< yaw rate [rad/s]
  double vy = 0.0;     ///< speed to the left [m/s], of a robot that drives sideways
};

}  // namespace slipwise
