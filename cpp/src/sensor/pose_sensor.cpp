// SPDX-License-Identifier: Apache-2.0
// The motion between two measured poses.
#include "slipwise/sensor/pose_sensor.hpp"

#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

/// H of derivations/uncertainty.md: a start measured too far left and turned too far left moves the end right and back.
Eigen::Matrix3d end_by_start(const Pose2& measured) {
  Eigen::Matrix3d by_start = -Eigen::Matrix3d::Identity();
  by_start(0, 2) = measured.y;
  by_start(1, 2) = -measured.x;
  return by_start;
}

Eigen::Matrix3d pose_covariance(const MotionNoise& noise, const PoseStdRatio& ratio) {
  const double xy = ratio.xy * noise.pose_std_xy;
  const double yaw = ratio.yaw * noise.pose_std_yaw;
  return Eigen::Vector3d(xy * xy, xy * xy, yaw * yaw).asDiagonal();
}

}  // namespace

Eigen::Matrix3d pose_noise_covariance(const Pose2& measured, const MotionNoise& noise,
                                      const std::array<PoseStdRatio, 2>& ratio) {
  const Eigen::Matrix3d from_start = end_by_start(measured);
  return from_start * pose_covariance(noise, ratio[0]) * from_start.transpose() + pose_covariance(noise, ratio[1]);
}

Eigen::Matrix3d shared_pose_noise(const Pose2& measured, const Pose2& before, const MotionNoise& noise,
                                  const PoseStdRatio& ratio) {
  Eigen::Matrix3d seen_there = Eigen::Matrix3d::Identity();  // turns back to the frame of the earlier start
  seen_there.topLeftCorner<2, 2>() = rotation(-before.theta);
  return end_by_start(measured) * seen_there * pose_covariance(noise, ratio);
}

Directions PoseSensor::directions() { return Eigen::Matrix<Eigen::Index, 3, 1>(kAlong, kAcross, kTurn); }

Moments PoseSensor::moments(double start, double end) { return Eigen::Vector2d(start, end); }

Seen PoseSensor::see(const View& view) {
  const Pose2 moved = between(view.robot[0], view.robot[1]);
  const Eigen::Matrix3d by_motion = sensor_by_robot(moved, view.place);
  const Eigen::Matrix2d into_start = rotation(-view.robot[0].theta);
  Eigen::Matrix3d by_end = Eigen::Matrix3d::Identity();
  by_end.topLeftCorner<2, 2>() = into_start;
  Eigen::Matrix3d by_start = end_by_start(moved);
  by_start.topLeftCorner<2, 2>() = -into_start;
  return {.z = sensor_motion(moved, view.place).vector(),
          .by_pose = {by_motion * by_start, by_motion * by_end},
          .by_place = sensor_by_extrinsics(moved, view.place)};
}

RowsCovariance PoseSensor::noise(const View& view, const MotionNoise& noise) const {
  return pose_noise_covariance(Pose2::from_vector(view.measured), noise, std_ratio);
}

}  // namespace slipwise
