// SPDX-License-Identifier: Apache-2.0
// What data say of parameters.
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "slipwise/filter/observability.hpp"

namespace slipwise {
namespace {

TEST_CASE("without data every ratio is one") {
  const Eigen::VectorXd std = Eigen::Vector2d(0.5, 3.0);
  const Estimate prior{Eigen::VectorXd::Zero(2), std.cwiseAbs2().asDiagonal()};
  const Observability observed = observability(prior, std);
  CHECK(observed.ratio.isApprox(Eigen::VectorXd::Ones(2)));
  CHECK(observed.weakest_ratio == doctest::Approx(1.0));
}

TEST_CASE("a sum that is known leaves the difference as the weakest direction") {
  // Unit priors and one exact look at p0 + p1: only their difference keeps its prior variance.
  const Eigen::MatrixXd covariance = (Eigen::Matrix2d() << 0.5, -0.5, -0.5, 0.5).finished();
  const Observability observed = observability({Eigen::VectorXd::Zero(2), covariance}, Eigen::Vector2d::Ones());
  CHECK(observed.weakest_ratio == doctest::Approx(1.0));
  CHECK(std::abs(observed.weakest[0] + observed.weakest[1]) < 1e-12);
  CHECK(observed.ratio[0] == doctest::Approx(0.5));
}

TEST_CASE("sizes that do not fit are refused") {
  const Estimate posterior{Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2)};
  CHECK_THROWS_AS(observability(posterior, Eigen::Vector3d::Ones()), std::invalid_argument);
  CHECK_THROWS_AS(observability(posterior, Eigen::Vector2d(1.0, 0.0)), std::invalid_argument);
}

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
