// SPDX-License-Identifier: Apache-2.0
// The one instantiation of Eigen's Cholesky factors for matrices of any size.
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {

Cholesky::Cholesky(const Eigen::Ref<const Eigen::MatrixXd>& matrix) : factor_(matrix) {}

double Cholesky::log_determinant() const { return 2.0 * factor_.matrixLLT().diagonal().array().log().sum(); }

Eigen::MatrixXd Cholesky::inverse() const {
  return factor_.solve(Eigen::MatrixXd::Identity(factor_.rows(), factor_.cols()));
}

Eigen::VectorXd Cholesky::solve_vector(const Eigen::Ref<const Eigen::VectorXd>& right) const {
  return factor_.solve(right);
}

Eigen::MatrixXd Cholesky::solve_columns(const Eigen::Ref<const Eigen::MatrixXd>& right) const {
  return factor_.solve(right);
}

Eigen::VectorXd solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                const Eigen::Ref<const Eigen::VectorXd>& right) {
  return Eigen::LDLT<Eigen::MatrixXd>(matrix).solve(right);
}

Eigen::MatrixXd solve_symmetric_columns(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                        const Eigen::Ref<const Eigen::MatrixXd>& right) {
  return Eigen::LDLT<Eigen::MatrixXd>(matrix).solve(right);
}

}  // namespace slipwise
