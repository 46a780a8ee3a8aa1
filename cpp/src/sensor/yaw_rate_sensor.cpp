// SPDX-License-Identifier: Apache-2.0
// The turns between moments.
#include "slipwise/sensor/yaw_rate_sensor.hpp"

#include <algorithm>

namespace slipwise {

Directions YawRateSensor::directions() const { return Directions::Constant(covariance.rows(), kTurn); }

Moments YawRateSensor::moments(double start, double end) const {
  return Moments::LinSpaced(covariance.rows() + 1, start, end);
}

Seen YawRateSensor::see(const View& view) const {
  const Eigen::Index pieces = covariance.rows();
  Seen seen{.z = Rows(pieces), .by_pose = {}, .by_place = RowsByPose::Zero(pieces, 3)};
  std::fill_n(seen.by_pose.begin(), pieces + 1, RowsByPose::Zero(pieces, 3));
  for (Eigen::Index i = 0; i < pieces; ++i) {
    const auto place = static_cast<std::size_t>(i);
    seen.z[i] = view.robot[place + 1].theta - view.robot[place].theta;
    seen.by_pose[place](i, 2) = -1.0;
    seen.by_pose[place + 1](i, 2) = 1.0;
  }
  return seen;
}

RowsCovariance YawRateSensor::noise(const View& /*view*/, const MotionNoise& /*noise*/) const { return covariance; }

}  // namespace slipwise
