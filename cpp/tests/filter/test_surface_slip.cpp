// SPDX-License-Identifier: Apache-2.0
// The slip of a surface beside what is the robot's.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "slipwise/filter/surface_slip.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {
namespace {

/// Two slip parameters and one of the robot's, all correlated.
Estimate joint() {
  Eigen::Matrix3d root;
  root << 0.2, 0.0, 0.0, 0.05, 0.1, 0.0, 0.08, -0.03, 0.3;
  return {Eigen::Vector3d(-0.1, -0.3, 0.5), root * root.transpose()};
}

const Eigen::Vector2d kStd(0.3, 0.3);
const ReferenceSpeeds kSurfaceSpeeds{.v = 1.0, .omega = 0.5};

SurfaceSlip at(double a, double b, double std) {
  return {.mean = Eigen::Vector2d(a, b),
          .covariance = std * std * Eigen::Matrix2d::Identity(),
          .by_robot = Eigen::MatrixXd::Zero(2, 0),
          .robot = Eigen::VectorXd(0),
          .prior_std = kStd,
          .speeds = kSurfaceSpeeds};
}

TEST_CASE("a surface that is left and taken again at once is as it was") {
  const Estimate before = joint();
  const SurfaceSlip surface = surface_of(before, Eigen::Vector3d::Ones(), kStd, kSurfaceSpeeds);
  const Estimate after = joined_with(surface, before.mean.tail(1), before.covariance.bottomRightCorner(1, 1));
  CHECK(after.mean.isApprox(before.mean, 1e-12));
  CHECK(after.covariance.isApprox(before.covariance, 1e-12));
}

TEST_CASE("what another surface tells of the robot reaches a surface as it would have directly") {
  const Estimate prior = joint();
  const Eigen::RowVector3d measures(0.0, 0.0, 1.0);  // the robot alone, as seen on another surface
  const double noise = 0.01;
  const double innovation = 0.2;
  const Eigen::Vector3d gain =
      prior.covariance * measures.transpose() / (measures * prior.covariance * measures.transpose() + noise);
  const Estimate direct{prior.mean + gain * innovation, prior.covariance - gain * measures * prior.covariance};
  const SurfaceSlip surface = surface_of(prior, Eigen::Vector3d::Ones(), kStd, kSurfaceSpeeds);
  const Estimate recalled = joined_with(surface, direct.mean.tail(1), direct.covariance.bottomRightCorner(1, 1));
  CHECK(recalled.mean.isApprox(direct.mean, 1e-12));
  CHECK(recalled.covariance.isApprox(direct.covariance, 1e-12));
}

TEST_CASE("an inflated covariance is remembered as inflated") {
  const SurfaceSlip plain = surface_of(joint(), Eigen::Vector3d::Ones(), kStd, kSurfaceSpeeds);
  const SurfaceSlip wide = surface_of(joint(), Eigen::Vector3d::Constant(2.0), kStd, kSurfaceSpeeds);
  CHECK(wide.covariance.isApprox(4.0 * plain.covariance, 1e-12));
  CHECK(wide.by_robot == plain.by_robot);
}

TEST_CASE("two memories of one surface count their common prior once") {
  const double std = 0.3 / std::sqrt(2.0);  // prior and one measurement as exact as it
  const SurfaceSlip both = merged(at(-0.1, 0.0, std), at(-0.1, 0.2, std));
  CHECK(both.covariance(0, 0) == doctest::Approx(0.09 / 3.0));
  CHECK(both.mean[0] == doctest::Approx(-0.4 / 3.0));
  CHECK(both.mean[1] == doctest::Approx(0.4 / 3.0));
}

TEST_CASE("a new surface is expected between those that are known, and as far away as they are from each other") {
  const Eigen::VectorXd robot(0);
  const std::vector<SurfaceSlip> alike{at(-0.1, -0.3, 0.01), at(-0.11, -0.31, 0.01), at(-0.09, -0.3, 0.01)};
  const std::vector<SurfaceSlip> apart{at(-0.1, -0.3, 0.01), at(-0.5, -0.9, 0.01), at(-0.3, 0.3, 0.01)};
  const SurfaceSlip near = shrunk_prior(alike, robot, kStd, kSurfaceSpeeds);
  const SurfaceSlip far = shrunk_prior(apart, robot, kStd, kSurfaceSpeeds);
  CHECK(near.mean[0] == doctest::Approx(-0.1).epsilon(0.1));
  CHECK(near.mean[1] == doctest::Approx(-0.3).epsilon(0.1));
  CHECK(near.covariance(1, 1) < 0.02);
  CHECK(far.covariance(1, 1) > 2.0 * near.covariance(1, 1));
  CHECK(shrunk_prior({}, robot, kStd, kSurfaceSpeeds).mean.isZero());
}

TEST_CASE("the prior of a new surface is a covariance") {
  const std::vector<SurfaceSlip> known{at(-0.1, -0.3, 0.05)};
  const SurfaceSlip fresh = shrunk_prior(known, Eigen::VectorXd(0), kStd, kSurfaceSpeeds);
  CHECK(symmetric_eigen(fresh.covariance).values.minCoeff() > 0.0);
  CHECK(fresh.covariance(0, 0) > 0.05 * 0.05);
}

}  // namespace
}  // namespace slipwise
