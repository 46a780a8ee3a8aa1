// SPDX-License-Identifier: Apache-2.0
// The turn between two moments.
#include "slipwise/sensor/yaw_rate_sensor.hpp"

namespace slipwise {
namespace {

using Row = Eigen::Matrix<double, 1, 1>;
using RowByPose = Eigen::Matrix<double, 1, 3>;

}  // namespace

Directions YawRateSensor::directions() { return Eigen::Matrix<Eigen::Index, 1, 1>(kTurn); }

Moments YawRateSensor::moments(double start, double end) { return Eigen::Vector2d(start, end); }

Seen YawRateSensor::see(const View& view) {
  return {.z = Row(view.robot[1].theta - view.robot[0].theta),
          .by_pose = {RowByPose(0.0, 0.0, -1.0), RowByPose(0.0, 0.0, 1.0)},
          .by_place = RowByPose::Zero()};
}

RowsCovariance YawRateSensor::noise(const View& /*view*/, const MotionNoise& /*noise*/) const { return Row(std * std); }

}  // namespace slipwise
