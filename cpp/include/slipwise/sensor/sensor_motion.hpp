// SPDX-License-Identifier: Apache-2.0
// How the motion of a sensor follows from that of the robot which carries it, with derivatives
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/lie/se2.hpp"

namespace slipwise {

/// X^-1 T X: the motion T of the robot as the sensor at X in base_link makes it. The turn is the same.
inline Pose2 sensor_motion(const Pose2& robot, const Pose2& sensor) { return between(sensor, compose(robot, sensor)); }

/// Derivative of the chart (x, y, theta) of the sensor's motion by that of the robot's.
inline Eigen::Matrix3d sensor_by_robot(const Pose2& robot, const Pose2& sensor) {
  const Eigen::Matrix2d into_sensor = rotation(-sensor.theta);
  const Eigen::Vector2d lever = rotation(robot.theta) * Eigen::Vector2d(sensor.x, sensor.y);
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Identity();
  derivative.topLeftCorner<2, 2>() = into_sensor;
  derivative.topRightCorner<2, 1>() = into_sensor * Eigen::Vector2d(-lever.y(), lever.x());
  return derivative;
}

/// Derivative of the chart of the sensor's motion by where the sensor sits (x, y, yaw).
inline Eigen::Matrix3d sensor_by_extrinsics(const Pose2& robot, const Pose2& sensor) {
  const Pose2 motion = sensor_motion(robot, sensor);
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();
  derivative.topLeftCorner<2, 2>() = rotation(-sensor.theta) * (rotation(robot.theta) - rotation(0.0));
  derivative(0, 2) = motion.y;
  derivative(1, 2) = -motion.x;
  return derivative;
}

}  // namespace slipwise
