// SPDX-License-Identifier: Apache-2.0
// Mean and covariance of slip ahead are those of draws from the mixture.
#include "slipwise/slip/mixed_ahead.hpp"

#include <doctest/doctest.h>

#include <random>

namespace slipwise {
namespace {

const std::vector<SurfaceMoments> kSurfaces{
    {Eigen::Vector2d(0.1, 0.0), (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.02).finished()},
    {Eigen::Vector2d(-0.2, 0.3), (Eigen::Matrix2d() << 0.01, 0.0, 0.0, 0.09).finished()}};

/// Of all stretches together, [slip * stretches] each way.
Eigen::MatrixXd covariance_of(const MixedAhead& mixed) {
  const Eigen::Index size = mixed.directions.front().size();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (const Eigen::MatrixXd& direction : mixed.directions) {
    const Eigen::VectorXd flat = direction.reshaped();
    sum += flat * flat.transpose();
  }
  return sum;
}

TEST_CASE("moments over three stretches are those of a hundred thousand draws") {
  const Eigen::MatrixXd odds = (Eigen::MatrixXd(3, 2) << 1.0, 0.0, 0.7, 0.3, 0.2, 0.8).finished();
  const MixedAhead mixed = mix_ahead({1.0, 3.0}, odds, kSurfaces);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  constexpr int kDraws = 100000;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(6);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(6, 6);
  for (int i = 0; i < kDraws; ++i) {
    std::array<Eigen::Vector2d, 2> slip;
    for (std::size_t s = 0; s < 2; ++s) {
      const Eigen::Matrix2d root = kSurfaces[s].covariance.llt().matrixL();
      slip[s] = kSurfaces[s].slip + root * Eigen::Vector2d(normal(random), normal(random));
    }
    Eigen::VectorXd drawn(6);
    for (Eigen::Index k = 0; k < 3; ++k) {
      drawn.segment<2>(2 * k) = slip[uniform(random) < odds(k, 0) ? 0 : 1];
    }
    mean += drawn / kDraws;
    square += drawn * drawn.transpose() / kDraws;
  }
  Eigen::VectorXd stated(6);
  stated << mixed.slip, mixed.slip + mixed.ahead.changes[0],
      mixed.slip + mixed.ahead.changes[0] + mixed.ahead.changes[1];
  CHECK((stated - mean).cwiseAbs().maxCoeff() < 0.004);
  CHECK((covariance_of(mixed) - (square - mean * mean.transpose())).cwiseAbs().maxCoeff() < 0.002);
}

TEST_CASE("one surface all along is one error for all stretches") {
  const MixedAhead mixed = mix_ahead({2.0}, Eigen::MatrixXd::Ones(2, 1), std::span(kSurfaces).first(1));
  CHECK(mixed.directions.size() == 2);
  for (const Eigen::MatrixXd& direction : mixed.directions) {
    CHECK(direction.col(0) == direction.col(1));
  }
  CHECK(mixed.ahead.changes.front().isZero());
}

TEST_CASE("noise is as large as on the roughest stretch that a path comes to") {
  std::vector<SurfaceMoments> surfaces = kSurfaces;
  surfaces[1].noise_scale << 3.0, 2.0, 0.5;
  const Eigen::MatrixXd odds = (Eigen::MatrixXd(3, 2) << 1.0, 0.0, 0.5, 0.5, 0.0, 1.0).finished();
  const MixedAhead mixed = mix_ahead({1.0, 3.0}, odds, surfaces);
  CHECK(mixed.noise_scale_until(0.9) == Eigen::Vector3d::Ones());
  CHECK(mixed.noise_scale_until(1.1) == Eigen::Vector3d(2.0, 1.5, 1.0));
  CHECK(mixed.noise_scale_until(5.0) == Eigen::Vector3d(3.0, 2.0, 1.0));
}

TEST_CASE("what is no distribution over surfaces is refused") {
  CHECK_THROWS_AS(mix_ahead({}, Eigen::RowVector2d(0.5, 0.4), kSurfaces), std::invalid_argument);
  CHECK_THROWS_AS(mix_ahead({}, Eigen::RowVector2d(1.5, -0.5), kSurfaces), std::invalid_argument);
  CHECK_THROWS_AS(mix_ahead({1.0}, Eigen::RowVector2d(0.5, 0.5), kSurfaces), std::invalid_argument);
  CHECK_THROWS_AS(mix_ahead({}, Eigen::RowVector2d(0.5, 0.5), std::span(kSurfaces).first(1)), std::invalid_argument);
  CHECK_THROWS_AS(mix_ahead({-1.0}, Eigen::Matrix2d::Identity(), kSurfaces), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
