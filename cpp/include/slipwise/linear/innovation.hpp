// SPDX-License-Identifier: Apache-2.0
// What filters of measured poses ask of the covariance S of an innovation; compiled once.
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// r^T S^-1 r, the normalised innovation squared (NIS).
double normalised_square(const Eigen::Vector3d& r, const Eigen::Matrix3d& s);

/// S^-1 B.
Eigen::Matrix3Xd solve_innovation(const Eigen::Matrix3d& s, const Eigen::Ref<const Eigen::Matrix3Xd>& b);

/// (S^-1 H P)^T, the Kalman gain, of H P.
inline Eigen::MatrixX3d kalman_gain(const Eigen::Matrix3d& s, const Eigen::Ref<const Eigen::Matrix3Xd>& hp) {
  return solve_innovation(s, hp).transpose();
}

}  // namespace slipwise
