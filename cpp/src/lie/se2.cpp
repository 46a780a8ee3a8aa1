// SPDX-License-Identifier: Apache-2.0
// SE(2) in matrices, compiled once.
#include "slipwise/lie/se2.hpp"

namespace slipwise {

Eigen::Matrix3d adjoint(const Pose2& pose) {
  Eigen::Matrix3d ad = Eigen::Matrix3d::Identity();
  ad.topLeftCorner<2, 2>() = rotation(pose.theta);
  ad(0, 2) = pose.y;
  ad(1, 2) = -pose.x;
  return ad;
}

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& tangent) {
  Eigen::Matrix3d jacobian = chart_jacobian(tangent);
  jacobian.topRows<2>() = rotation(-tangent.z()) * jacobian.topRows<2>().eval();
  return jacobian;
}

Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& tangent) { return right_jacobian(-tangent); }

Eigen::Matrix3d transition(const Pose2& world_a, const Pose2& world_b) {
  Eigen::Matrix3d phi = Eigen::Matrix3d::Identity();
  phi(0, 2) = -(world_b.y - world_a.y);
  phi(1, 2) = world_b.x - world_a.x;
  return phi;
}

}  // namespace slipwise
