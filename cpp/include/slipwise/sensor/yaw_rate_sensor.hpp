// SPDX-License-Identifier: Apache-2.0
// A gyro: by how much the robot turned.
#pragma once

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/sensor/seen.hpp"

namespace slipwise {

/// One row: the integral of the yaw rate from the start to the end of a segment [rad].
struct YawRateSensor {
  double std = 0.0;  ///< of the turn [rad]

  static Directions directions();
  static Moments moments(double start, double end);
  static Seen see(const View& view);
  RowsCovariance noise(const View& view, const MotionNoise& noise) const;
  static void come_earlier(double /*seconds*/) {}
};

}  // namespace slipwise
