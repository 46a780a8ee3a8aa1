// SPDX-License-Identifier: Apache-2.0
// Positions, laid on those of a fitted way.
#include "slipwise/sensor/position_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr double kLeast = 0.1;      // of the noise of one position, or of a heading: no fit is known better
constexpr double kTogether = 1e-6;  // [m^2] ways that have less in common have no angle to speak of

Eigen::Vector2d left_of(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

Positions seen_positions(const View& view) {
  Positions seen(2, static_cast<Eigen::Index>(view.robot.size()));
  for (Eigen::Index i = 0; i < seen.cols(); ++i) {
    const Pose2 there = sensor_motion(view.robot[static_cast<std::size_t>(i)], view.place);
    seen.col(i) << there.x, there.y;
  }
  return seen;
}

/// Positions turned and moved to where they lie best on the fitted ones.
struct Laid {
  Eigen::Matrix2d turned;
  Positions positions;
  double together;
};

Laid laid(const PositionSensor& sensor, Positions positions) {
  positions.colwise() -= centre_of(positions, sensor.weights);
  const BestTurn turn = best_turn(positions, sensor.fitted, sensor.weights);
  const Eigen::Matrix2d turned = rotation(turn.angle);
  return {.turned = turned, .positions = turned * positions, .together = std::max(turn.together, kTogether)};
}

Eigen::Vector3d motion_of(const PositionSensor& sensor, const Laid& laid) {
  const Positions apart = laid.positions - sensor.fitted;
  return sensor.motion + sensor.gain * apart.reshaped();
}

}  // namespace

Eigen::Vector2d centre_of(const Positions& positions, const OfPositions& weights) {
  return positions * weights / weights.sum();
}

BestTurn best_turn(const Positions& from, const Positions& onto, const OfPositions& weights) {
  double along = 0.0;
  double across = 0.0;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    along += weights[i] * from.col(i).dot(onto.col(i));
    across += weights[i] * left_of(from.col(i)).dot(onto.col(i));
  }
  return {.angle = std::atan2(across, along), .together = std::hypot(along, across)};
}

Directions PositionSensor::directions() const {
  return Eigen::Matrix<Eigen::Index, 3, 1>(kAlong, kAcross, turn ? kTurn : kAcross);
}

Moments PositionSensor::moments(double /*start*/, double /*end*/) const { return at; }

Eigen::Vector3d PositionSensor::motion_by(const Positions& positions) const {
  return motion_of(*this, laid(*this, positions));
}

/// The gain does not see where all positions are moved to; as they turn by the best angle, it sees by `turning`.
Seen PositionSensor::see(const View& view) const {
  const Laid now = laid(*this, seen_positions(view));
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < now.positions.cols(); ++i) {
    turning += gain.middleCols<2>(2 * i) * left_of(now.positions.col(i));
  }
  Seen seen{.z = motion_of(*this, now), .by_pose = {}, .by_place = RowsByPose::Zero(3, 3)};
  for (Eigen::Index i = 0; i < now.positions.cols(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    const Eigen::RowVector2d angle = left_of(fitted.col(i)).transpose() * (weights[i] / now.together);
    const Eigen::Matrix<double, 3, 2> by_position = (gain.middleCols<2>(2 * i) - turning * angle) * now.turned;
    const Pose2& robot = view.robot[place];
    seen.by_pose[place] = by_position * sensor_by_robot(robot, view.place).topRows<2>();
    seen.by_place += by_position * sensor_by_extrinsics(robot, view.place).topRows<2>();
  }
  seen.by_place.col(2).setZero();  // an antenna has no heading
  return seen;
}

RowsCovariance PositionSensor::noise(const View& /*view*/, const MotionNoise& noise) const {
  const Eigen::Array3d least = kLeast * Eigen::Array3d(noise.pose_std_xy, noise.pose_std_xy, noise.pose_std_yaw);
  Eigen::Matrix3d covariance = least.square().matrix().asDiagonal();
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const auto by_mean = gain.middleCols<2>(2 * i);
    covariance += by_mean * by_mean.transpose() / weights[i];
  }
  return covariance;
}

void PositionSensor::come_earlier(double seconds) { at.array() -= seconds; }

}  // namespace slipwise
