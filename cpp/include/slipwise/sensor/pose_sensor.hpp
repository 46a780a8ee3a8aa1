// SPDX-License-Identifier: Apache-2.0
// A sensor of poses: how it moved between the start and the end of a segment.
#pragma once

#include <Eigen/Core>
#include <array>

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/sensor/seen.hpp"

namespace slipwise {

/// How exact a measured pose is said to be beside others: factors of the standard deviations of its noise.
struct PoseStdRatio {
  double xy = 1.0;
  double yaw = 1.0;
};

/// Covariance of a measured T_start_end because both poses are measured: H R1 H^T + R2, with each pose's
/// standard deviations times its ratios.
Eigen::Matrix3d pose_noise_covariance(const Pose2& measured, const MotionNoise& noise,
                                      const std::array<PoseStdRatio, 2>& ratio = {});
/// Covariance of the chart of a measured motion with that of the one before it, where they meet at one measured pose.
Eigen::Matrix3d shared_pose_noise(const Pose2& measured, const Pose2& before, const MotionNoise& noise,
                                  const PoseStdRatio& ratio = {});

/// Rows: the chart (x, y, theta) of X^-1 T X, the heading unwrapped, of a sensor at X on a robot that moved by T.
struct PoseSensor {
  std::array<PoseStdRatio, 2> std_ratio = {};  ///< of the first and the second pose

  static Directions directions();
  static Moments moments(double start, double end);
  static Seen see(const View& view);
  RowsCovariance noise(const View& view, const MotionNoise& noise) const;
  static void come_earlier(double /*seconds*/) {}
};

}  // namespace slipwise
