// SPDX-License-Identifier: Apache-2.0
// What pulls a robot on tilted ground, in its own axes.
#pragma once

namespace slipwise {

/// Body-frame gravity [m/s^2], zero on flat terrain, and the heading in the frame of the poses.
struct BodyGravity {
  double gx = 0.0;
  double gy = 0.0;
  double cos_yaw = 1.0;
  double sin_yaw = 0.0;
};

}  // namespace slipwise
