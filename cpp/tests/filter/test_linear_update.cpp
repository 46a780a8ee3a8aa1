// SPDX-License-Identifier: Apache-2.0
// No measurement takes more than there is.
#include "slipwise/filter/linear_update.hpp"

#include <doctest/doctest.h>

#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {
TEST_CASE("variances stay positive however exact the measurements, and what is known stays so") {
  Eigen::MatrixXd covariance = Eigen::Vector4d(1e6, 1.0, 1e-6, 0.0).asDiagonal();
  Eigen::Matrix3Xd h(3, 4);
  h << 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0;
  for (int i = 0; i < 100; ++i) {
    linear_update(covariance, h, Eigen::Matrix3d(1e-10 * Eigen::Matrix3d::Identity()));
    CHECK(covariance.diagonal().minCoeff() >= 0.0);
    CHECK(symmetric_eigen(covariance).values.minCoeff() > -1e-16);
    CHECK(covariance.row(3).isZero(0.0));
  }
}

}  // namespace slipwise
