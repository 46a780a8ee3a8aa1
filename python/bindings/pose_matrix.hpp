// SPDX-License-Identifier: Apache-2.0
// Poses as rows x, y [m], yaw [rad] of a matrix.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/lie/se2.hpp"

namespace slipwise::bindings {

inline Eigen::MatrixX3d pose_matrix(const std::vector<Pose2>& poses) {
  Eigen::MatrixX3d matrix(static_cast<Eigen::Index>(poses.size()), 3);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) = poses[i].vector();
  }
  return matrix;
}

}  // namespace slipwise::bindings
