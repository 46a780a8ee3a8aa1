// SPDX-License-Identifier: Apache-2.0
// Non-negative least squares from its normal equations (Lawson and Hanson's active set).
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// The x >= 0 that minimises x^T A x / 2 - b^T x, for a symmetric positive definite A. The search begins at `near` >=
/// 0: the closer it is, the shorter it takes.
/// \throws std::invalid_argument when sizes differ or A is not positive definite.
Eigen::VectorXd nonnegative_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& near);

}  // namespace slipwise
