// SPDX-License-Identifier: Apache-2.0
// Where the robot is, and whether it moves as it must: measured poses, and between them what a learner knows.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "slipwise/motion/motion_model.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/motion_leg.hpp"
#include "slipwise/online/motion_monitor.hpp"
#include "slipwise/online/pose_filter.hpp"
#include "slipwise/online/stamp_spacing.hpp"

namespace slipwise {

/// Where the robot is, and how it moves, as nav_msgs/Odometry says it.
struct Odometry {
  double t;                          ///< [s] stamp of the newest measurement
  long frame;                        ///< of the last pose used
  Pose2 pose;                        ///< of base_link in the frame of the measured poses; its yaw is not wrapped
  Eigen::Matrix3d covariance;        ///< of (x, y, yaw) [m, m, rad] in the axes of that frame
  BodyTwist twist;                   ///< of base_link in its own axes, slip included
  Eigen::Matrix3d twist_covariance;  ///< of (v, vy, omega) [m/s, m/s, rad/s]
  double since_pose;                 ///< [s] since the last pose that was used was measured
};

/// What is known of the motion now.
struct MotionNow {
  const InputBuffer& inputs;  ///< that it is predicted from
  double newest;              ///< [s] stamp of the newest measurement
  double latency;             ///< [s] by which streams may be late relative to each other
  double learned;             ///< [s] of segments
  PoseLateness late;          ///< of the poses: they, and legs, count by their own clock
  /// What predicts a leg at `t` [s], its errors as those over a `horizon` [s] were.
  std::function<LegKnowledge(double t, double horizon)> at;
  std::function<MotionLeg(const LegKnowledge& known, double start, double end)> leg;
};

/// Changes nothing of what is learned.
class Localizer {
 public:
  explicit Localizer(const PoseFilterSettings& settings);

  /// Another run begins.
  void restart();
  /// Takes a pose, whose stamp is later than those before.
  void push(const MeasuredPose& pose);
  /// An input came that is stamped `t` [s]: what was predicted without it is predicted again.
  void forget_without(double t) { filter_.forget_without(t); }
  /// Where the robot is at the newest measurement; nothing before the first pose of the run.
  std::optional<Odometry> odometry(const MotionNow& motion);
  /// Whether it moves as its inputs and the model say it must.
  MotionState monitor(const MotionNow& motion);

 private:
  PoseFilter filter_;
  MotionMonitor monitor_;
};

}  // namespace slipwise
