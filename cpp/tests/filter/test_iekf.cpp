// SPDX-License-Identifier: Apache-2.0
// The IEKF: recovery, equality with the linear solution, robustness, and its status.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "sample_bases.hpp"
#include "simulated_drive.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

const Eigen::Matrix3d kExact = 1e-6 * Eigen::Matrix3d::Identity();

/// Straight driving makes the last pose linear in the forward slip.
InputHistory straight_inputs() {
  const std::vector<double> t{0.0}, v{1.0}, zero{0.0};
  return {t, v, zero, zero};
}

TEST_CASE("the filter recovers slip and clock offset within three sigma") {
  const MotionModel model(named_basis("odd-even-10"), {.clock_offset = true});
  Eigen::VectorXd truth(11);
  truth << tests::sample_slip(model.basis(), 51, 0.08), 0.07;
  const auto drive = tests::simulate_drive(model, truth, {.seed = 52, .windows = 100, .noise = tests::kNoise});
  Estimate estimate = tests::wide_prior(model);
  for (const Segment& segment : drive.segments) {
    const Eigen::Matrix3d noise = tests::window_noise(model, estimate.mean, drive.inputs, segment, tests::kNoise);
    estimate = iekf_update(model, estimate, drive.inputs, segment, noise).estimate;
  }
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    CAPTURE(i);
    const double sigma = std::sqrt(estimate.covariance(i, i));
    CHECK(std::abs(estimate.mean[i] - truth[i]) < 3.0 * sigma);
    CHECK(sigma < 0.1);
  }
}

TEST_CASE("the filter recovers lags and delays") {
  const MotionModel model(named_basis("edd-2"), {.dynamics = true});
  Eigen::VectorXd truth(6), start(6);
  truth << -0.08, -0.15, std::log(0.5), std::log(0.3), std::log(0.12), std::log(0.15);
  start << 0.0, 0.0, std::log(0.3), std::log(0.3), std::log(0.1), std::log(0.1);
  const auto drive =
      tests::simulate_drive(model, truth, {.seed = 53, .windows = 150, .window = 2.0, .noise = tests::kNoise});
  Estimate estimate{start, 0.25 * Eigen::MatrixXd::Identity(6, 6)};
  for (const Segment& segment : drive.segments) {
    const Eigen::Matrix3d noise = tests::window_noise(model, estimate.mean, drive.inputs, segment, tests::kNoise);
    estimate = iekf_update(model, estimate, drive.inputs, segment, noise).estimate;
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    CAPTURE(i);
    CHECK(std::abs(estimate.mean[i] - truth[i]) < 3.5 * std::sqrt(estimate.covariance(i, i)));
  }
  CHECK(estimate.mean[2] == doctest::Approx(truth[2]).epsilon(0.15));
  CHECK(estimate.mean[3] == doctest::Approx(truth[3]).epsilon(0.15));
}

// Linearised where it began, at a lag of 0.3 s, the filter would be sure of a lag that is far too long.
TEST_CASE("the filter stays honest on its way to a short lag behind a long delay") {
  const MotionModel model(named_basis("edd-2"), {.dynamics = true});
  Eigen::VectorXd truth(6), start(6);
  truth << -0.08, -0.15, std::log(0.07), std::log(0.06), std::log(0.22), std::log(0.2);
  start << 0.0, 0.0, std::log(0.3), std::log(0.3), std::log(0.1), std::log(0.1);
  for (const unsigned seed : {61U, 62U, 63U}) {
    const auto drive =
        tests::simulate_drive(model, truth, {.seed = seed, .windows = 100, .window = 2.5, .noise = tests::kNoise});
    Estimate estimate{start, Eigen::VectorXd{{0.04, 0.04, 0.64, 0.64, 0.64, 0.64}}.asDiagonal()};
    for (const Segment& segment : drive.segments) {
      const Eigen::Matrix3d noise = tests::window_noise(model, estimate.mean, drive.inputs, segment, tests::kNoise);
      estimate = iekf_update(model, estimate, drive.inputs, segment, noise).estimate;
    }
    for (Eigen::Index i = 0; i < truth.size(); ++i) {
      CAPTURE(i);
      CAPTURE(estimate.mean[i]);
      CHECK(std::abs(estimate.mean[i] - truth[i]) < 4.5 * std::sqrt(estimate.covariance(i, i)));
    }
  }
}

TEST_CASE("on a linear problem the filter is the Kalman filter") {
  const std::vector<std::string> lon{"V"}, lat{"V"}, none;
  const MotionModel model(Basis("linear", lon, lat, none), {});
  const InputHistory inputs = straight_inputs();
  Estimate prior = tests::wide_prior(model);
  prior.covariance(0, 1) = prior.covariance(1, 0) = 0.01;
  const Segment segment{.start = 1.0, .end = 3.0, .measured = measured_pose({1.9, 0.1, 0.02})};
  Eigen::Matrix3d noise = Eigen::Vector3d(0.04, 0.09, 0.01).asDiagonal();
  noise(0, 2) = noise(2, 0) = 0.005;
  const IekfUpdate update = iekf_update(model, prior, inputs, segment, noise);
  Eigen::Matrix<double, 3, 2> h = Eigen::Matrix<double, 3, 2>::Zero();
  h(0, 0) = h(1, 1) = 2.0;
  const Eigen::Matrix2d information = prior.covariance.inverse() + h.transpose() * noise.inverse() * h;
  const Eigen::Vector3d innovation(-0.1, 0.1, 0.02);
  const Eigen::Vector2d mean = information.inverse() * h.transpose() * noise.inverse() * innovation;
  const Eigen::Matrix3d s = h * prior.covariance * h.transpose() + noise;
  CHECK((update.estimate.mean - mean).norm() < 1e-12);
  CHECK((update.estimate.covariance - information.inverse()).norm() < 1e-12);
  CHECK((update.innovation - innovation).norm() < 1e-12);
  CHECK((update.innovation_covariance - s).norm() < 1e-12);
  CHECK(update.nis == doctest::Approx(innovation.dot(s.inverse() * innovation)).epsilon(1e-10));
  CHECK(update.weight == 1.0);
  auto at_prior = linearize_segment(model, prior.mean, inputs, segment);
  const IekfUpdate same = iekf_update(model, prior, inputs, segment, std::move(at_prior), noise);
  CHECK(same.estimate.mean == update.estimate.mean);
  CHECK(same.estimate.covariance == update.estimate.covariance);
  CHECK(update.status == Status::Converged);
}

TEST_CASE("covariances stay symmetric, positive definite, and never grow in any basis") {
  for (const Basis& basis : tests::all_bases()) {
    CAPTURE(basis.name());
    const MotionModel model(basis, {.clock_offset = true});
    Eigen::VectorXd truth(model.size());
    truth << tests::sample_slip(basis, 54, 0.05), -0.03;
    const auto drive = tests::simulate_drive(model, truth, {.seed = 55, .windows = 20, .noise = tests::kNoise});
    Estimate estimate = tests::wide_prior(model);
    for (const Segment& segment : drive.segments) {
      const Eigen::MatrixXd before = estimate.covariance;
      const Eigen::Matrix3d noise = tests::window_noise(model, estimate.mean, drive.inputs, segment, tests::kNoise);
      estimate = iekf_update(model, estimate, drive.inputs, segment, noise).estimate;
      CHECK(estimate.covariance == estimate.covariance.transpose());
      CHECK(Cholesky(estimate.covariance).positive_definite());
      CHECK(estimate.covariance.trace() <= before.trace() * (1.0 + 1e-12));
    }
  }
}

TEST_CASE("a residual beyond the gate leaves the estimate as it was and says so") {
  const MotionModel model(named_basis("edd-2"), {});
  const Estimate prior = tests::wide_prior(model, 0.01);
  const Segment jump{.start = 1.0, .end = 2.0, .measured = measured_pose({1.0, 5.0, 0.0})};
  const IekfUpdate update = iekf_update(model, prior, straight_inputs(), jump, 0.01 * Eigen::Matrix3d::Identity());
  CHECK(update.nis == doctest::Approx(2500.0));
  CHECK(update.status == Status::Rejected);
  CHECK(update.weight == 0.0);
  CHECK(update.estimate.mean == prior.mean);
  CHECK(update.estimate.covariance == prior.covariance);
  CHECK(advice(update.status).find("rejected") != std::string_view::npos);
}

TEST_CASE("a residual between Huber's threshold and the gate counts for less") {
  const MotionModel model(named_basis("edd-2"), {});
  const Estimate prior = tests::wide_prior(model, 0.1);
  const Segment odd{.start = 1.0, .end = 2.0, .measured = measured_pose({1.0 + 5.0 * std::sqrt(0.02), 0.0, 0.0})};
  const Eigen::Matrix3d noise = 0.01 * Eigen::Matrix3d::Identity();
  const IekfUpdate update = iekf_update(model, prior, straight_inputs(), odd, noise);
  const IekfUpdate trusting = iekf_update(model, prior, straight_inputs(), odd, noise, {.huber = 100.0});
  CHECK(update.nis == doctest::Approx(25.0));
  CHECK(update.weight == doctest::Approx(0.5));
  CHECK(update.status == Status::Downweighted);
  CHECK(trusting.status == Status::Converged);
  CHECK(update.estimate.mean[0] < trusting.estimate.mean[0]);
  CHECK(update.estimate.covariance(0, 0) > trusting.estimate.covariance(0, 0));
}

TEST_CASE("step halving keeps a far start from diverging") {
  const MotionModel model(named_basis("edd-2"), {});
  const std::vector<double> t{0.0}, v{2.0}, vy{0.0}, omega{1.0};
  const InputHistory inputs(t, v, vy, omega);
  const Eigen::Vector2d truth(0.0, 0.9);
  Segment segment{.start = 0.0, .end = 3.0};
  segment.measured = measured_pose(integrate_segment(model, truth, inputs, segment).poses.back());
  const Estimate prior = tests::wide_prior(model, 1.0);
  const auto cost = [&](const IekfSettings& settings) {
    const Estimate estimate = iekf_update(model, prior, inputs, segment, kExact, settings).estimate;
    const Pose2 reached = integrate_segment(model, estimate.mean, inputs, segment).poses.back();
    return (reached.vector() - rows_of(segment.measured)).norm();
  };
  const double start = rows_of(segment.measured).norm();
  for (const int iterations : {1, 2, 5, 10}) {
    CHECK(cost({.iterations = iterations, .huber = 1e9, .gate = 1e18}) < start);
  }
  CHECK(cost({.iterations = 10, .huber = 1e9, .gate = 1e18}) < 1e-4);
}

TEST_CASE("a perfect fit is no failure") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const Eigen::VectorXd truth = tests::sample_slip(model.basis(), 56);
  const auto drive = tests::simulate_drive(model, truth, {.seed = 57, .windows = 20});
  Estimate estimate{truth, 0.01 * Eigen::MatrixXd::Identity(10, 10)};
  for (const Segment& segment : drive.segments) {
    const IekfUpdate update = iekf_update(model, estimate, drive.inputs, segment, kExact);
    CHECK(update.status == Status::Converged);
    estimate = update.estimate;
  }
  CHECK((estimate.mean - truth).norm() < 1e-9);
}

TEST_CASE("sizes that do not fit and numbers that are not finite are refused with what was expected") {
  const MotionModel model(named_basis("edd-2"), {});
  const Segment segment{.start = 1.0, .end = 2.0};
  const auto update = [&](const Estimate& prior, const Segment& s, const Eigen::Matrix3d& noise) {
    return iekf_update(model, prior, straight_inputs(), s, noise);
  };
  const Estimate good = tests::wide_prior(model);
  CHECK_THROWS_WITH_AS(update({Eigen::VectorXd::Zero(3), good.covariance}, segment, kExact),
                       doctest::Contains("takes 2 parameters, got 3"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(update({good.mean, Eigen::MatrixXd::Identity(3, 3)}, segment, kExact),
                       doctest::Contains("one row per parameter, 2; got 3 x 3"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(update(good, {.start = 2.0, .end = 2.0}, kExact), doctest::Contains("end after it starts"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      update(good, {.start = 1.0, .end = 2.0, .measured = measured_pose({std::nan(""), 0.0, 0.0})}, kExact),
      doctest::Contains("finite measurements"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(update(good, segment, Eigen::Matrix3d::Zero()), doctest::Contains("positive definite"),
                       std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
