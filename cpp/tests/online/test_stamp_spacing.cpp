// SPDX-License-Identifier: Apache-2.0
// A clock offset is no surer than its stamps support; all else stays as it was.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "slipwise/online/stamp_spacing.hpp"

namespace slipwise {
namespace {

std::shared_ptr<const MotionPosterior> with_offset_std(double std) {
  const MotionModel model(named_basis("edd-2"), {.clock_offset = true});
  Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  covariance(2, 2) = std * std;
  covariance(0, 2) = covariance(2, 0) = 0.5e-2 * std;
  return std::make_shared<const MotionPosterior>(
      MotionPosterior{.model = model,
                      .estimate = {Eigen::Vector3d(-0.1, -0.3, 0.02), covariance},
                      .prior_std = Eigen::Vector3d(0.3, 0.3, 0.2),
                      .noise = {},
                      .noise_scale = Eigen::Vector3d::Ones(),
                      .variance_ratio = Eigen::Vector3d(0.1, 0.1, 0.1)});
}

}  // namespace

TEST_CASE("an offset that is surer than evenly spread stamps allow is widened to what they allow") {
  const auto sure = with_offset_std(1e-5);
  const auto wider = supported(sure, 0.1, 300);
  const double least = 0.1 / std::sqrt(12.0 * 300.0);
  CHECK(std::sqrt(wider->estimate.covariance(2, 2)) == doctest::Approx(least));
  CHECK(wider->estimate.mean == sure->estimate.mean);
  CHECK(wider->estimate.covariance.topLeftCorner<2, 2>() == sure->estimate.covariance.topLeftCorner<2, 2>());
  const double correlation = wider->estimate.covariance(0, 2) / std::sqrt(wider->estimate.covariance(0, 0)) / least;
  CHECK(correlation == doctest::Approx(0.5));
  CHECK(wider->variance_ratio[2] > sure->variance_ratio[2]);
}

TEST_CASE("an offset that is less sure, or not learned, stays") {
  const auto unsure = with_offset_std(0.05);
  CHECK(supported(unsure, 0.1, 300) == unsure);
  CHECK(supported(unsure, 0.1, 0) == unsure);
  CHECK(supported(nullptr, 0.1, 300) == nullptr);
}

TEST_CASE("poses are late by the offset and half the spacing of the wheel speeds that it was learned from") {
  const auto offset = with_offset_std(0.003);
  const PoseLateness late = pose_lateness(*offset, 0.05);
  CHECK(late.mean == doctest::Approx(0.045));
  CHECK(late.std == doctest::Approx(std::hypot(0.003, 0.05 / std::sqrt(12.0))));
}

TEST_CASE("wheel speeds behind commands are measured, not held") {
  MotionPosterior behind = *with_offset_std(0.003);
  behind.model = MotionModel({"none", {}, {}, {}}, {.clock_offset = true, .response = true});
  behind.estimate = {Eigen::VectorXd::Constant(behind.model.size(), 0.02),
                     1e-4 * Eigen::MatrixXd::Identity(behind.model.size(), behind.model.size())};
  behind.variance_ratio = Eigen::VectorXd::Constant(behind.model.size(), 0.1);
  CHECK(pose_lateness(behind, 0.05).mean == doctest::Approx(0.02));
}

TEST_CASE("where the offset is not identified, or the poses come first, they are not late") {
  MotionPosterior posterior = *with_offset_std(0.003);
  posterior.variance_ratio[2] = 0.6;
  CHECK(pose_lateness(posterior, 0.05).mean == 0.0);
  posterior.variance_ratio[2] = 0.1;
  posterior.estimate.mean[2] = -0.2;
  CHECK(pose_lateness(posterior, 0.05).mean == 0.0);
  CHECK(pose_lateness(posterior, 0.05).std == 0.0);
  posterior.model = MotionModel(named_basis("edd-2"), {.delays = true});
  CHECK(pose_lateness(posterior, 0.05).mean == 0.0);
}

}  // namespace slipwise
