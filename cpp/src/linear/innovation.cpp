// SPDX-License-Identifier: Apache-2.0
// By Cholesky factors.
#include "slipwise/linear/innovation.hpp"

#include <Eigen/Cholesky>

namespace slipwise {

double normalised_square(const Eigen::Vector3d& r, const Eigen::Matrix3d& s) { return r.dot(s.llt().solve(r)); }

double normalised_square(const Eigen::VectorXd& r, const Eigen::Ref<const Eigen::MatrixXd>& s) {
  return r.dot(Cholesky(s).solve(r));
}

double normalised_square(const Rows& r, const RowsCovariance& s) {
  return r.size() == 3 ? normalised_square(Eigen::Vector3d(r), Eigen::Matrix3d(s)) : r.dot(s.llt().solve(r));
}

Rows solve_innovation(const RowsCovariance& s, const Rows& b) { return s.llt().solve(b); }

RowsJacobian solve_innovation(const RowsCovariance& s, const RowsJacobian& b) { return s.llt().solve(b); }

Eigen::VectorXd solve_innovation(const Eigen::MatrixXd& s, const Eigen::VectorXd& b) { return Cholesky(s).solve(b); }

Eigen::Matrix3Xd solve_innovation(const Eigen::Matrix3d& s, const Eigen::Ref<const Eigen::Matrix3Xd>& b) {
  return s.llt().solve(b);
}

}  // namespace slipwise
