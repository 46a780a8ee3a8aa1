// SPDX-License-Identifier: Apache-2.0
// The batch fit: recovery, equality with the filter on a linear problem, robustness, refusals.
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "sample_bases.hpp"
#include "simulated_drive.hpp"
#include "slipwise/filter/batch.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

std::vector<BatchDatum> data_of(const MotionModel& model, const tests::SimulatedDrive& drive) {
  std::vector<BatchDatum> data;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  for (const Segment& segment : drive.segments) {
    data.push_back({drive.inputs, segment, tests::window_noise(model, zero, drive.inputs, segment, tests::kNoise)});
  }
  return data;
}

/// Straight windows that meet, for a model whose chart is linear in its parameters.
struct LinearDrive {
  MotionModel model = straight_model();
  InputHistory inputs = ramp();
  std::vector<BatchDatum> data;

  explicit LinearDrive(const Eigen::Matrix3d& shared) {
    for (int i = 1; i < 18; ++i) {
      Segment segment{.start = i + 0.3, .end = i + 1.3};
      segment.measured = measured_pose({0.55 + 0.1 * i + 0.03 * std::sin(3.0 * i), 0.02 * i, 0.001});
      data.push_back({inputs, segment, 0.01 * Eigen::Matrix3d::Identity(), shared});
    }
    data.front().shared.setZero();
  }

  static MotionModel straight_model() {
    const std::vector<std::string> lon{"V", "V^2"}, lat{"V"}, none;
    return {Basis("linear", lon, lat, none), {}};
  }

  static InputHistory ramp() {
    std::vector<double> t, v, zero;
    for (int i = 0; i < 20; ++i) {
      t.push_back(i);
      v.push_back(0.5 + 0.1 * i);
      zero.push_back(0.0);
    }
    return {t, v, zero, zero};
  }
};

TEST_CASE("the batch fit recovers slip and clock offset within three sigma") {
  const MotionModel model(named_basis("odd-even-10"), {.clock_offset = true});
  Eigen::VectorXd truth(11);
  truth << tests::sample_slip(model.basis(), 61, 0.08), -0.05;
  const auto drive = tests::simulate_drive(model, truth, {.seed = 62, .windows = 60, .noise = tests::kNoise});
  const BatchFit fit = batch_fit(model, tests::wide_prior(model), data_of(model, drive));
  CHECK(fit.status == Status::Converged);
  CHECK(fit.iterations < 15);
  CHECK(Cholesky(fit.estimate.covariance).positive_definite());
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    CAPTURE(i);
    CHECK(std::abs(fit.estimate.mean[i] - truth[i]) < 3.0 * std::sqrt(fit.estimate.covariance(i, i)));
  }
}

TEST_CASE("on a linear problem the filter and the batch fit agree") {
  const LinearDrive drive(Eigen::Matrix3d::Zero());
  Estimate filtered = tests::wide_prior(drive.model);
  for (const BatchDatum& datum : drive.data) {
    filtered = iekf_update(drive.model, filtered, drive.inputs, datum.segment, datum.noise).estimate;
  }
  const BatchFit fit = batch_fit(drive.model, tests::wide_prior(drive.model), drive.data, {.tolerance = 1e-14});
  CHECK((fit.estimate.mean - filtered.mean).norm() < 1e-7);
  CHECK((fit.estimate.covariance - filtered.covariance).norm() < 1e-10);
}

TEST_CASE("errors that neighbours fraction are weighted as generalised least squares weighs them") {
  Eigen::Matrix3d shared;
  shared << -0.004, 0.001, 0.0, 0.0, -0.003, 0.002, 0.001, 0.0, -0.004;
  const LinearDrive drive(shared);
  const Estimate prior = tests::wide_prior(drive.model);
  const auto n = std::ssize(drive.data);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  Eigen::MatrixXd by_parameter(3 * n, drive.model.size());
  Eigen::VectorXd residual(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const BatchDatum& datum = drive.data[static_cast<std::size_t>(i)];
    const auto at = linearize_segment(drive.model, prior.mean, drive.inputs, datum.segment);
    by_parameter.middleRows<3>(3 * i) = at.by_parameter;
    residual.segment<3>(3 * i) = rows_of(datum.segment.measured) - at.predicted;
    noise.block<3, 3>(3 * i, 3 * i) = datum.noise;
    if (i > 0) {
      noise.block<3, 3>(3 * i, 3 * i - 3) = shared;
      noise.block<3, 3>(3 * i - 3, 3 * i) = shared.transpose();
    }
  }
  const Cholesky whole(noise);
  REQUIRE(whole.positive_definite());
  const Eigen::MatrixXd by_noise = whole.solve(by_parameter);
  const Cholesky information(by_parameter.transpose() * by_noise + Cholesky(prior.covariance).inverse());
  const Eigen::VectorXd evidence = by_noise.transpose() * residual;
  const Eigen::VectorXd mean = information.solve(evidence);
  const BatchFit fit = batch_fit(drive.model, prior, drive.data, {.tolerance = 1e-14, .huber = 1e9});
  CHECK((fit.estimate.mean - mean).norm() < 1e-7);
  CHECK((fit.estimate.covariance - information.inverse()).norm() < 1e-10);
}

TEST_CASE("a fit from near its end takes fewer steps to the same place") {
  const LinearDrive drive(Eigen::Matrix3d::Zero());
  const BatchFit fit = batch_fit(drive.model, tests::wide_prior(drive.model), drive.data);
  const BatchFit again =
      batch_fit(drive.model, tests::wide_prior(drive.model), drive.data, {.start = fit.estimate.mean});
  CHECK(again.iterations < fit.iterations);
  CHECK((again.estimate.mean - fit.estimate.mean).norm() < 1e-6);
}

TEST_CASE("errors that share more than they have are refused") {
  const LinearDrive drive(0.02 * Eigen::Matrix3d::Identity());
  CHECK_THROWS_WITH_AS(batch_fit(drive.model, tests::wide_prior(drive.model), drive.data),
                       doctest::Contains("segment 1 shares more noise"), std::invalid_argument);
  CHECK_THROWS_AS(
      batch_fit(drive.model, tests::wide_prior(drive.model), drive.data, {.start = Eigen::VectorXd::Zero(2)}),
      std::invalid_argument);
}

TEST_CASE("one pose jump hardly moves a robust fit") {
  const MotionModel model(named_basis("edd-2"), {});
  const Eigen::Vector2d truth(-0.1, -0.2);
  auto drive = tests::simulate_drive(model, truth, {.seed = 63, .windows = 40, .noise = tests::kNoise});
  drive.segments[7].measured.front().z[0] += 3.0;
  const auto data = data_of(model, drive);
  const double robust = (batch_fit(model, tests::wide_prior(model), data).estimate.mean - truth).norm();
  const double trusting =
      (batch_fit(model, tests::wide_prior(model), data, {.huber = 1e9}).estimate.mean - truth).norm();
  CHECK(robust < 0.01);
  CHECK(trusting > 3.0 * robust);
}

TEST_CASE("too few iterations are reported") {
  const MotionModel model(named_basis("odd-even-10"), {});
  const auto drive =
      tests::simulate_drive(model, tests::sample_slip(model.basis(), 64), {.seed = 65, .noise = tests::kNoise});
  const BatchFit fit = batch_fit(model, tests::wide_prior(model), data_of(model, drive), {.iterations = 1});
  CHECK(fit.status == Status::NotConverged);
  CHECK(advice(fit.status).find("did not settle") != std::string_view::npos);
}

TEST_CASE("data that do not fit are refused with what was expected") {
  const MotionModel model(named_basis("edd-2"), {});
  const auto drive = tests::simulate_drive(model, Eigen::Vector2d::Zero(), {.windows = 2, .noise = tests::kNoise});
  auto data = data_of(model, drive);
  const Estimate prior = tests::wide_prior(model);
  CHECK_THROWS_WITH_AS(batch_fit(model, prior, {}), doctest::Contains("at least one segment"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(batch_fit(model, {Eigen::VectorXd::Zero(3), prior.covariance}, data),
                       doctest::Contains("takes 2 parameters, got 3"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(batch_fit(model, {prior.mean, Eigen::MatrixXd::Identity(3, 3)}, data),
                       doctest::Contains("one row per parameter, 2; got 3 x 3"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(batch_fit(model, {prior.mean, Eigen::MatrixXd::Zero(2, 2)}, data),
                       doctest::Contains("positive definite"), std::invalid_argument);
  data[1].noise.setZero();
  CHECK_THROWS_WITH_AS(batch_fit(model, prior, data), doctest::Contains("segment 1"), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
