// SPDX-License-Identifier: Apache-2.0
// Currents are described by size, spread and ratio to wheel speed.
#include "slipwise/terrain/current_features.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace slipwise {
namespace {

TEST_CASE("constant currents have their mean, no spread and no correlation") {
  Eigen::MatrixXd samples(20, kDriveColumns);
  samples.rowwise() = Eigen::RowVector4d(-2.0, 4.0, 0.5, -0.5);
  const Eigen::VectorXd found = current_features(samples);
  REQUIRE(found.size() == kCurrentFeatures);
  CHECK(found[0] == doctest::Approx(std::log(2.3)));
  CHECK(found[1] == doctest::Approx(std::log(0.1)));
  CHECK(found[6] == doctest::Approx(4.0));
  CHECK(found[12] == doctest::Approx(std::log(6.3 / 1.05)));
  CHECK(found[15] == 0.0);
}

TEST_CASE("sides that rise together are correlated") {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Ones(50, kDriveColumns);
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    samples(i, 0) = 2.0 + std::sin(static_cast<double>(i));
    samples(i, 1) = 2.0 * samples(i, 0);
  }
  CHECK(current_features(samples)[15] == doctest::Approx(1.0));
}

TEST_CASE("one row, or other columns, are refused") {
  CHECK_THROWS_AS((void)current_features(Eigen::MatrixXd::Ones(1, kDriveColumns)), std::invalid_argument);
  CHECK_THROWS_AS((void)current_features(Eigen::MatrixXd::Ones(9, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
