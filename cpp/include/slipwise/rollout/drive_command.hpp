// SPDX-License-Identifier: Apache-2.0
// What a robot is commanded to drive.
#pragma once

namespace slipwise {

struct DriveCommand {
  double v = 0.0;      ///< speed [m/s]
  double omega = 0.0;  ///< yaw rate [rad/s]
};

}  // namespace slipwise
