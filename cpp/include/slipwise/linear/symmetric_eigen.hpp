// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors of symmetric matrices of any size, compiled once.
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// A = V diag(values) V^T.
struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< one a column, orthonormal
};

/// A matrix whose product with its transpose is the covariance.
Eigen::MatrixXd covariance_root(const Eigen::Ref<const Eigen::MatrixXd>& covariance);

SymmetricEigen symmetric_eigen(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

}  // namespace slipwise
