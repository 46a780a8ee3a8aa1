// SPDX-License-Identifier: Apache-2.0
// Slip ratios of the two sides and a slip angle (thesis 2.5 to 2.7, signs corrected), as slip that is linear in (V, w).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// A side with rim speed s moves over the terrain at s (1 - i); the robot drifts sideways by vy = -vx tan(angle), so
/// that a positive angle is a drift to the right. The chart of the estimators is (left, right, angle).
struct SlipRatios {
  double left = 0.0;   ///< i_L [-]: positive where the side spins, negative where it is dragged
  double right = 0.0;  ///< i_R [-]
  double angle = 0.0;  ///< slip angle [rad]

  Eigen::Vector3d vector() const { return {left, right, angle}; }
  static SlipRatios from_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
};

inline constexpr double kLargestSlipRatio = 0.95;  ///< estimators keep |i| below it: at 1 a side stands still [-]
inline constexpr double kLargestSlipAngle = 1.0;   ///< and |angle| below this: at pi/2 the tangent is infinite [rad]

/// The nearest slip ratios that an estimator may take.
inline SlipRatios bounded(const SlipRatios& slip) {
  return {.left = std::clamp(slip.left, -kLargestSlipRatio, kLargestSlipRatio),
          .right = std::clamp(slip.right, -kLargestSlipRatio, kLargestSlipRatio),
          .angle = std::clamp(slip.angle, -kLargestSlipAngle, kLargestSlipAngle)};
}

/// The robot's twist from that at the wheels (2.2), its sides `wheel_separation` = 2c apart [m].
inline BodyTwist slipping_twist(const BodyTwist& wheels, const SlipRatios& slip, double wheel_separation) {
  const double c = wheel_separation / 2.0;
  const double left = (wheels.v - c * wheels.omega) * (1.0 - slip.left);
  const double right = (wheels.v + c * wheels.omega) * (1.0 - slip.right);
  const double vx = (left + right) / 2.0;
  return {.v = vx, .vy = wheels.vy - vx * std::tan(slip.angle), .omega = (right - left) / wheel_separation};
}

struct LinearSlip {
  Eigen::Matrix<double, 6, 1> alpha;           ///< parameters of full-linear-6
  Eigen::Matrix<double, 6, 3> by_slip_ratios;  ///< their derivative by (left, right, angle)
};

/// The same slip as parameters of the basis full-linear-6: lon.V, lon.w, lat.V, lat.w, ang.V, ang.w.
inline LinearSlip linear_slip(const SlipRatios& slip, double wheel_separation) {
  const double c = wheel_separation / 2.0;
  const double mean = (slip.left + slip.right) / 2.0;
  const double half = (slip.right - slip.left) / 2.0;
  const double tangent = std::tan(slip.angle);
  const double derivative = 1.0 + tangent * tangent;
  LinearSlip linear;
  linear.alpha << -mean, -c * half, -tangent * (1.0 - mean), tangent * c * half, -half / c, -mean;
  linear.by_slip_ratios << -0.5, -0.5, 0.0,                          //
      c / 2.0, -c / 2.0, 0.0,                                        //
      tangent / 2.0, tangent / 2.0, -derivative * (1.0 - mean),      //
      -tangent * c / 2.0, tangent * c / 2.0, derivative * c * half,  //
      0.5 / c, -0.5 / c, 0.0,                                        //
      -0.5, -0.5, 0.0;
  return linear;
}

}  // namespace slipwise
