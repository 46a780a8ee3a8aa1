// SPDX-License-Identifier: Apache-2.0
// What filters ask of the covariance S of an innovation: of a measured pose, compiled once, and of any size.
#pragma once

#include <Eigen/Core>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/rows.hpp"

namespace slipwise {

/// r^T S^-1 r, the normalised innovation squared (NIS).
double normalised_square(const Eigen::Vector3d& r, const Eigen::Matrix3d& s);
double normalised_square(const Eigen::VectorXd& r, const Eigen::Ref<const Eigen::MatrixXd>& s);
double normalised_square(const Rows& r, const RowsCovariance& s);

/// S^-1 B.
Eigen::Matrix3Xd solve_innovation(const Eigen::Matrix3d& s, const Eigen::Ref<const Eigen::Matrix3Xd>& b);
Eigen::VectorXd solve_innovation(const Eigen::MatrixXd& s, const Eigen::VectorXd& b);
Rows solve_innovation(const RowsCovariance& s, const Rows& b);
RowsJacobian solve_innovation(const RowsCovariance& s, const RowsJacobian& b);

/// S = H P H^T + R, of as many rows as the Jacobian H has.
template <class Jacobian, class Noise>
auto innovation_covariance(const Eigen::MatrixXd& prior, const Eigen::MatrixBase<Jacobian>& jacobian,
                           const Eigen::MatrixBase<Noise>& noise) {
  constexpr int kRows = Jacobian::RowsAtCompileTime;
  constexpr int kMost = Jacobian::MaxRowsAtCompileTime;
  const Eigen::Matrix<double, kRows, Eigen::Dynamic, Eigen::ColMajor, kMost> spread = jacobian * prior;
  Eigen::Matrix<double, kRows, kRows, Eigen::ColMajor, kMost, kMost> s = noise;
  if constexpr (kRows == Eigen::Dynamic) {
    s.noalias() += spread * jacobian.transpose();
  } else {
    s += spread.lazyProduct(jacobian.transpose());
  }
  return s;
}

}  // namespace slipwise
