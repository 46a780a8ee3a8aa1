// SPDX-License-Identifier: Apache-2.0
// Cholesky factors solve what they factor, say where there is none, and agree with the matrix itself.
#include "slipwise/linear/cholesky.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>

namespace slipwise {
namespace {

Eigen::MatrixXd sample(Eigen::Index n) {
  Eigen::MatrixXd root(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      root(i, j) = std::sin(1.0 + static_cast<double>(3 * i + 7 * j));
    }
  }
  return root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
}

TEST_CASE("a factor solves for a column and for several") {
  const Eigen::MatrixXd a = sample(6);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(6, -1.0, 2.0);
  const Cholesky factor(a);
  CHECK(factor.positive_definite());
  CHECK((a * factor.solve(b) - b).norm() < 1e-12);
  CHECK((a * factor.solve(a.leftCols<2>()) - a.leftCols<2>()).norm() < 1e-11);
  CHECK((a * factor.inverse() - Eigen::MatrixXd::Identity(6, 6)).norm() < 1e-12);
  CHECK(factor.log_determinant() == doctest::Approx(std::log(a.determinant())).epsilon(1e-12));
}

TEST_CASE("a matrix that is not positive definite has no factor") {
  Eigen::MatrixXd a = sample(3);
  a(1, 1) = -1.0;
  CHECK_FALSE(Cholesky(a).positive_definite());
}

TEST_CASE("a symmetric matrix that is nearly singular is solved by pivots") {
  Eigen::MatrixXd a = sample(4);
  a.row(3) *= 1e-9;
  a.col(3) *= 1e-9;
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(4);
  CHECK((solve_symmetric(a, a * x) - x).norm() < 1e-6);
  CHECK((a * solve_symmetric_columns(a, a) - a).norm() < 1e-12);
}

}  // namespace
}  // namespace slipwise
