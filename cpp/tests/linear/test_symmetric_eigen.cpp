// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and eigenvectors put a symmetric matrix together again.
#include "slipwise/linear/symmetric_eigen.hpp"

#include <doctest/doctest.h>

namespace slipwise {
namespace {

TEST_CASE("eigenvalues rise, eigenvectors are orthonormal, and together they are the matrix") {
  Eigen::Matrix3d a;
  a << 4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 5.0;
  const SymmetricEigen eigen = symmetric_eigen(a);
  CHECK(eigen.values[0] <= eigen.values[1]);
  CHECK(eigen.values[1] <= eigen.values[2]);
  CHECK((eigen.vectors.transpose() * eigen.vectors - Eigen::Matrix3d::Identity()).norm() < 1e-14);
  CHECK((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - a).norm() < 1e-13);
}

TEST_CASE("a matrix without rows has no eigenvalues, and its root is one") {
  CHECK(symmetric_eigen(Eigen::MatrixXd(0, 0)).values.size() == 0);
  CHECK(covariance_root(Eigen::MatrixXd(0, 0)).size() == 0);
}

TEST_CASE("the root of a covariance gives it back, singular or slightly negative by rounding too") {
  Eigen::Matrix3d full;
  full << 4.0, 1.0, 0.5, 1.0, 2.0, -0.3, 0.5, -0.3, 1.0;
  const Eigen::Vector3d direction(1.0, -2.0, 0.5);
  for (const Eigen::Matrix3d& covariance : {full, Eigen::Matrix3d(direction * direction.transpose()),
                                            Eigen::Matrix3d(-1e-18 * Eigen::Matrix3d::Identity())}) {
    const Eigen::MatrixXd root = covariance_root(covariance);
    CHECK((root * root.transpose() - covariance).norm() < 1e-12);
  }
}

}  // namespace
}  // namespace slipwise
