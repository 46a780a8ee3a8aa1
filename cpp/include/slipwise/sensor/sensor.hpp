// SPDX-License-Identifier: Apache-2.0
// A sensor, and what one measured of a segment. A kind of sensor is a struct: which rows it has, the moments whose
// poses make them, these rows with derivatives, and their noise.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <variant>
#include <vector>

#include "slipwise/sensor/pose_sensor.hpp"
#include "slipwise/sensor/position_sensor.hpp"
#include "slipwise/sensor/yaw_rate_sensor.hpp"

namespace slipwise {

using SensorKind = std::variant<PoseSensor, PositionSensor, YawRateSensor>;

struct Sensor {
  std::size_t number = 0;                          ///< of the source
  Pose2 place = {};                                ///< in base_link, where no model learns it
  double clock = 0.0;                              ///< its stamps are so much later than those of the segment [s]
  bool calibrated = false;                         ///< its place and clock are known, and not those that a model learns
  Eigen::Vector3d noise_factor = {1.0, 1.0, 1.0};  ///< of the variances of (x, y, theta)
  bool own_noise = false;  ///< the factor is all of the noise's size: the filters' scale is not that of this sensor
  SensorKind kind = PoseSensor{};
};

/// The rows that a sensor measured.
struct Measured {
  Sensor sensor = {};
  Rows z = Rows::Zero(3);
};

Directions directions(const Sensor& sensor);
/// In stamps of the segment.
Moments moments(const Sensor& sensor, double start, double end);
/// h(path, parameters): the rows that a path makes, with derivatives.
Seen see(const Sensor& sensor, const View& view);
/// R of what is measured, before the factor of the sensor; that of the robot's slip is not in it.
RowsCovariance measurement_noise(const Sensor& sensor, const View& view, const MotionNoise& noise);
/// Moments of its own, beside the segment's start and end, are so much earlier [s].
void come_earlier(Sensor& sensor, double seconds);

/// A motion between two poses, as a sensor at `place` measured it.
std::vector<Measured> measured_pose(const Pose2& motion, const Pose2& place = {});
/// The rows of all.
Rows rows_of(const std::vector<Measured>& measured);
Rows stacked(const std::vector<Seen>& seen);
Directions directions_of(const std::vector<Measured>& measured);
/// Of the variances of each row: what the sensors have of their own, times a learned `scale` of (x, y, theta) where
/// that is theirs.
Rows noise_factors(const std::vector<Measured>& measured, const Eigen::Vector3d& scale);
/// A motion that is measured by rows x, y and theta. \throws std::invalid_argument where there are others.
Pose2 motion_of(const std::vector<Measured>& measured);
/// The chart (x, y, theta) that rows tell of, its turn the sum of their turns; nothing of a direction that no row has.
Eigen::Vector3d chart_of(const Directions& directions, const Rows& rows);
/// And its covariance, 1 of a direction that no row has.
Eigen::Matrix3d chart_covariance(const Directions& directions, const RowsCovariance& covariance);
/// A measured minus a predicted, turns by their shorter way.
Rows shorter_error(const Directions& directions, const Rows& measured, const Rows& predicted);

}  // namespace slipwise
