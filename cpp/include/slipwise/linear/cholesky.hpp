// SPDX-License-Identifier: Apache-2.0
// Cholesky factors of symmetric matrices of any size, compiled once: Eigen's own are compiled again wherever they are
// used.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace slipwise {

/// A = L L^T. Matrices of a fixed, small size use Eigen's own, which the compiler unrolls.
class Cholesky {
 public:
  explicit Cholesky(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

  bool positive_definite() const { return factor_.info() == Eigen::Success; }
  double log_determinant() const;   ///< of A
  Eigen::MatrixXd inverse() const;  ///< of A

  /// A^-1 b, for one column or several.
  template <typename Derived>
  auto solve(const Eigen::MatrixBase<Derived>& right) const {
    if constexpr (Derived::ColsAtCompileTime == 1) {
      return solve_vector(right);
    } else {
      return solve_columns(right);
    }
  }

 private:
  Eigen::VectorXd solve_vector(const Eigen::Ref<const Eigen::VectorXd>& right) const;
  Eigen::MatrixXd solve_columns(const Eigen::Ref<const Eigen::MatrixXd>& right) const;

  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// A^-1 b where A is symmetric and may be nearly singular: by pivoted L D L^T.
Eigen::VectorXd solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                const Eigen::Ref<const Eigen::VectorXd>& right);
Eigen::MatrixXd solve_symmetric_columns(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                                        const Eigen::Ref<const Eigen::MatrixXd>& right);

}  // namespace slipwise
