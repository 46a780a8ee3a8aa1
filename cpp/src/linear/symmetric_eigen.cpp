// SPDX-License-Identifier: Apache-2.0
// The one instantiation of Eigen's solver for symmetric matrices of any size.
#include "slipwise/linear/symmetric_eigen.hpp"

#include <Eigen/Eigenvalues>

namespace slipwise {

SymmetricEigen symmetric_eigen(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  if (matrix.size() == 0) {  // of a model without terms; the solver reads a first entry
    return {};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::MatrixXd covariance_root(const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace slipwise
