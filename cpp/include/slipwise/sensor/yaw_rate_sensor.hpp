// SPDX-License-Identifier: Apache-2.0
// A gyro: by how much the robot turned.
#pragma once

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/sensor/seen.hpp"

namespace slipwise {

/// A row for each of a few pieces of a segment that are equally long: the integral of the yaw rate over it [rad].
struct YawRateSensor {
  RowsCovariance covariance = {};  ///< of the turns [rad^2]

  Directions directions() const;
  Moments moments(double start, double end) const;
  Seen see(const View& view) const;
  RowsCovariance noise(const View& view, const MotionNoise& noise) const;
  static void come_earlier(double /*seconds*/) {}
};

}  // namespace slipwise
