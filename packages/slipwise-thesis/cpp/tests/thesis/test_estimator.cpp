// SPDX-License-Identifier: Apache-2.0
// All estimators by name behind one interface: recovery, priors that follow the speeds, and wrong names.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sample_bases.hpp"
#include "simulated_drive.hpp"
#include "slipwise/thesis/following_estimator.hpp"

namespace slipwise {
namespace {

TEST_CASE("every estimator recovers slip with the exact Jacobian; the thesis's filter does not with (6.7)") {
  const MotionModel model(named_basis("drive-5"), {});
  const Eigen::VectorXd truth = tests::sample_slip(model.basis(), 81, 0.1);
  const auto drive = tests::simulate_drive(model, truth, {.seed = 82, .windows = 200, .noise = tests::kNoise});
  for (const std::string& name : estimator_names()) {
    CAPTURE(name);
    for (const SegmentJacobian jacobian : {SegmentJacobian::Exact, SegmentJacobian::Thesis}) {
      EstimatorSettings settings;
      settings.noise = tests::kNoise;
      settings.ekf_thesis.jacobian = jacobian;
      Estimator estimator = make_estimator(name, model, tests::wide_prior(model), settings);
      for (const Segment& segment : drive.segments) {
        estimator.learn(drive.inputs, segment);
      }
      const bool misled = name == "ekf-thesis" && jacobian == SegmentJacobian::Thesis;
      const double error = (estimator.estimate().mean - truth).lpNorm<Eigen::Infinity>();
      CHECK((misled ? error > 0.05 : error < 0.02));
    }
  }
}

TEST_CASE("gradient descent has no covariance of its own: it keeps the prior's") {
  const MotionModel model(named_basis("edd-2"), {});
  const auto drive = tests::simulate_drive(model, Eigen::Vector2d(0.1, -0.1), {.seed = 83, .windows = 5});
  Estimator estimator = make_estimator("gradient-descent", model, tests::wide_prior(model), {});
  estimator.learn(drive.inputs, drive.segments.front());
  CHECK(estimator.estimate().covariance == tests::wide_prior(model).covariance);
  CHECK(estimator.estimate().mean.norm() > 0.0);
}

TEST_CASE("a gradient step of full rate without damping closes the residual to first order") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const auto drive =
      tests::simulate_drive(model, tests::sample_slip(model.basis(), 84, 1e-4), {.seed = 85, .windows = 1});
  EstimatorSettings settings;
  settings.gradient_descent = {.learning_rate = 1.0, .damping = 1e-12};
  Estimator estimator = make_estimator("gradient-descent", model, tests::wide_prior(model), settings);
  const double before = estimator.learn(drive.inputs, drive.segments[0]).innovation.norm();
  const double after = estimator.learn(drive.inputs, drive.segments[0]).innovation.norm();
  CHECK(before > 1e-5);
  CHECK(after < 1e-3 * before);
}

TEST_CASE("the thesis's filter is Table 6.1 line by line") {
  const MotionModel model(named_basis("thesis-15"), {});
  const auto drive = tests::simulate_drive(model, tests::sample_slip(model.basis(), 86, 0.02),
                                           {.seed = 87, .windows = 3, .noise = tests::kNoise});
  EstimatorSettings settings;
  settings.noise = tests::kNoise;
  settings.ekf_thesis.process_std = 0.01;
  Estimator estimator = make_estimator("ekf-thesis", model, tests::wide_prior(model), settings);
  Estimate expected = tests::wide_prior(model);
  for (const Segment& segment : drive.segments) {
    estimator.learn(drive.inputs, segment);
    const auto at = linearize_segment(model, expected.mean, drive.inputs, segment);
    const Eigen::Matrix3Xd j = thesis_jacobian(model, at, segment);
    const Eigen::MatrixXd predicted = expected.covariance + 1e-4 * tests::wide_prior(model).covariance;
    const Eigen::Matrix3d noise =
        slip_covariance(at.path, tests::kNoise) + pose_noise_covariance(motion_of(segment.measured), tests::kNoise);
    const Eigen::Matrix3Xd spread = j * predicted;
    const Eigen::Matrix3d s = spread * j.transpose() + noise;
    const Eigen::MatrixX3d k = spread.transpose() * s.inverse();
    expected.mean += k * (rows_of(segment.measured) - at.predicted);
    expected.covariance = predicted - k * spread;
  }
  CHECK((estimator.estimate().mean - expected.mean).norm() < 1e-10);
  CHECK((estimator.estimate().covariance - expected.covariance).norm() < 1e-10);
}

TEST_CASE("an unknown name is refused with the names that are known, a wrong prior with its size") {
  const MotionModel model(named_basis("edd-2"), {});
  CHECK_THROWS_WITH_AS(make_estimator("magic", model, tests::wide_prior(model), {}),
                       "unknown estimator 'magic'; known are gradient-descent, ekf-thesis, iekf, delayed-state, batch",
                       std::invalid_argument);
  CHECK_THROWS_AS(learns_overlapping_segments("magic"), std::invalid_argument);
  CHECK_THROWS_AS(make_estimator("iekf", model, {Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(3, 3)}, {}),
                  std::invalid_argument);
}

TEST_CASE("on its own the iekf behind the interface is the causal filter until that learns anew") {
  const MotionModel model(named_basis("odd-even-10"), {.clock_offset = true});
  Eigen::VectorXd truth(11);
  truth << tests::sample_slip(model.basis(), 88, 0.05), 0.05;
  const auto drive = tests::simulate_drive(model, truth, {.seed = 89, .windows = 7, .noise = tests::kNoise});
  const CausalFilterSettings settings;
  FollowingEstimator following("iekf", model, settings);
  CausalFilter filter(model, settings);
  DrivenSpeeds speeds;
  for (const Segment& segment : drive.segments) {
    following.learn(drive.inputs, segment);
    speeds.see(drive.inputs, segment);
    filter.learn(drive.inputs, segment, speeds.reference());
  }
  CHECK((following.estimate().mean - filter.estimate().mean).norm() < 1e-3);
  CHECK((following.noise_scale() - filter.noise_scale()).norm() < 0.02);
  CHECK((following.prior_std() - filter.prior_std()).norm() < 0.1 * filter.prior_std().norm());
}

TEST_CASE("every estimator takes a prior of other speeds") {
  const MotionModel model(named_basis("edd-2"), {});
  const auto drive =
      tests::simulate_drive(model, Eigen::Vector2d(-0.05, -0.2), {.seed = 90, .windows = 40, .noise = tests::kNoise});
  const Eigen::Vector2d old_std(0.2, 0.2), new_std(0.4, 0.1);
  for (const std::string& name : {std::string("iekf"), std::string("delayed-state"), std::string("batch")}) {
    CAPTURE(name);
    EstimatorSettings settings;
    settings.noise = tests::kNoise;
    settings.iekf = {.huber = 1e9, .gate = 1e18};
    Estimator changed = make_estimator(name, model, tests::wide_prior(model), settings);
    Estimate prior = tests::wide_prior(model);
    prior.covariance.diagonal() = new_std.cwiseAbs2();
    Estimator known = make_estimator(name, model, prior, settings);
    for (const Segment& segment : drive.segments) {
      changed.learn(drive.inputs, segment);
      known.learn(drive.inputs, segment);
    }
    CHECK(changed.change_prior(old_std, new_std));
    CHECK((changed.estimate().mean - known.estimate().mean).norm() < 1e-4);
    CHECK((changed.estimate().covariance - known.estimate().covariance).norm() <
          1e-2 * known.estimate().covariance.norm());
  }
}

}  // namespace
}  // namespace slipwise
