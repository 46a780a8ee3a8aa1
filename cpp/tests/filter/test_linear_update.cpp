// SPDX-License-Identifier: Apache-2.0
// A linear measurement adds its information, whatever the sizes.
#include "slipwise/filter/linear_update.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace slipwise {
namespace {

/// By information: P^-1 + H^T R^-1 H, and the gain P' H^T R^-1.
template <class Matrix, class ByState, class Noise>
void check_update(const Matrix& prior, const ByState& h, const Noise& r) {
  Matrix updated = prior;
  const auto gain = linear_update(updated, h, r);
  const Eigen::MatrixXd expected = (prior.inverse() + h.transpose() * r.inverse() * h).inverse();
  CHECK((updated - expected).norm() < 1e-12 * expected.norm());
  CHECK((gain - expected * h.transpose() * r.inverse()).norm() < 1e-12);
  CHECK(updated == updated.transpose());
}

}  // namespace

TEST_CASE("a measurement adds its information, in states of any size") {
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(5, 5);
  const Eigen::MatrixXd prior = root * root.transpose() + Eigen::MatrixXd::Identity(5, 5);
  const Eigen::Matrix3d noise = Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal();
  check_update(prior, Eigen::Matrix3Xd(Eigen::Matrix3Xd::Random(3, 5)), noise);
  check_update(prior, Eigen::RowVectorXd(Eigen::RowVectorXd::Random(5)), Eigen::Matrix<double, 1, 1>(0.5));
  check_update(Eigen::Matrix3d(prior.topLeftCorner<3, 3>()), Eigen::Matrix3d(Eigen::Matrix3d::Random()), noise);
  check_update(Eigen::Matrix<double, 1, 1>(2.0), Eigen::Matrix<double, 1, 1>(1.0), Eigen::Matrix<double, 1, 1>(0.5));
  Eigen::MatrixXd nothing(0, 0);
  CHECK(linear_update(nothing, Eigen::Matrix3Xd(3, 0), noise).size() == 0);
}

TEST_CASE("variances stay positive however exact the measurements, and what is known stays so") {
  Eigen::MatrixXd covariance = Eigen::Vector4d(1e6, 1.0, 1e-6, 0.0).asDiagonal();
  Eigen::Matrix3Xd h(3, 4);
  h << 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0;
  for (int i = 0; i < 100; ++i) {
    linear_update(covariance, h, Eigen::Matrix3d(1e-10 * Eigen::Matrix3d::Identity()));
    CHECK(covariance.diagonal().minCoeff() >= 0.0);
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues().minCoeff() > -1e-16);
    CHECK(covariance.row(3).isZero(0.0));
  }
}

}  // namespace slipwise
