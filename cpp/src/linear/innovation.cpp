// SPDX-License-Identifier: Apache-2.0
// Cholesky factors of 3 x 3 covariances.
#include "slipwise/linear/innovation.hpp"

#include <Eigen/Cholesky>

namespace slipwise {

double normalised_square(const Eigen::Vector3d& r, const Eigen::Matrix3d& s) { return r.dot(s.llt().solve(r)); }

Eigen::Matrix3Xd solve_innovation(const Eigen::Matrix3d& s, const Eigen::Ref<const Eigen::Matrix3Xd>& b) {
  return s.llt().solve(b);
}

}  // namespace slipwise
