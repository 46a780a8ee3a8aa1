// SPDX-License-Identifier: Apache-2.0
// What data say of parameters.
#include <doctest/doctest.h>

#include "slipwise/filter/observability.hpp"

namespace slipwise {
namespace {

TEST_CASE("pairs that go together are found, the closest first, whatever their units") {
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(4, 4);
  correlation(0, 2) = correlation(2, 0) = -0.95;
  correlation(1, 3) = correlation(3, 1) = 0.99;
  correlation(0, 1) = correlation(1, 0) = 0.2;
  const Eigen::Vector4d unit(1e-3, 1.0, 50.0, 2.0);
  const auto pairs = correlated_pairs(unit.asDiagonal() * correlation * unit.asDiagonal(), 0.9);
  REQUIRE(pairs.size() == 2);
  CHECK(pairs[0].first == 1);
  CHECK(pairs[0].second == 3);
  CHECK(pairs[1].correlation == doctest::Approx(-0.95));
}

TEST_CASE("a parameter that is known exactly goes with no other") {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2, 2);
  covariance(0, 0) = 1.0;
  CHECK(correlated_pairs(covariance, 0.9).empty());
  CHECK(correlated_pairs(Eigen::MatrixXd(0, 0), 0.9).empty());
}

}  // namespace
}  // namespace slipwise
