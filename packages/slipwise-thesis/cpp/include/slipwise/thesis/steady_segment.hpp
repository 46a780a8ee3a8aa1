// SPDX-License-Identifier: Apache-2.0
// A path driven under one held command, its prediction, and how white slip noise spreads it
// (derivations/thesis.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"

namespace slipwise {

/// Poses observed from the first of them; times since the first [s]. The first pose, the origin at time 0, tells
/// nothing.
struct SteadySegment {
  BodyTwist command;
  std::vector<double> times;  ///< [N], 0 and increasing [s]
  std::vector<Pose2> poses;   ///< [N], headings unwrapped
};

/// Noise of a steady drive. Channels are lon, lat, ang; charts are (x, y, theta) observed from the start.
struct SteadyNoise {
  Eigen::Vector3d psd = Eigen::Vector3d::Zero();    ///< of the slip rates [m^2/s, m^2/s, rad^2/s]
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< diagonal of P0 [m^2, m^2, rad^2]
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();   ///< variance of each later measured pose [m^2, m^2, rad^2]
};

/// Where a constant twist leads within `time` [s].
Pose2 steady_pose(const BodyTwist& twist, double time);
/// Derivative of its chart by the twist (v, vy, omega): E t of derivations/model.md.
Eigen::Matrix3d steady_jacobian(const BodyTwist& twist, double time);

/// The stacked covariance of the charts at `times` [K] for a unit of each noise: psd (3), then start (3); [3K, 3K]
/// each.
/// \throws std::invalid_argument when the times are not positive and increasing.
std::array<Eigen::MatrixXd, 6> steady_covariance_parts(const BodyTwist& twist, std::span<const double> times);
/// Their sum for this noise, with the pose noise on the diagonal; [3K, 3K].
Eigen::MatrixXd steady_covariance(const BodyTwist& twist, std::span<const double> times, const SteadyNoise& noise);

}  // namespace slipwise
