// SPDX-License-Identifier: Apache-2.0
// Slip noise and P0 of simulated groups: recovery, coverage, the thesis's objective against Fisher scoring, refusals.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "slipwise/thesis/noise_fit.hpp"
#include "slipwise/thesis/slip_rate_fit.hpp"
#include "steady_group.hpp"

namespace slipwise {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 stacked(const SteadyNoise& noise) { return (Vector6() << noise.psd, noise.start).finished(); }

NoiseGroup group_of(const tests::SteadyScript& script) {
  const auto segments = tests::simulate_group(script);
  const SlipRateFit fit = fit_slip_rates(segments);
  NoiseGroup group{.twist = {.v = script.command.v + fit.slip.x(),
                             .vy = script.command.vy + fit.slip.y(),
                             .omega = script.command.omega + fit.slip.z()},
                   .times = {segments[0].times.begin() + 1, segments[0].times.end()},
                   .residuals = fit.residuals};
  return group;
}

/// What many seeds say about one objective.
struct Trial {
  Vector6 mean = Vector6::Zero();
  Vector6 mean_squared_error = Vector6::Zero();
  Vector6 within_two_sigma = Vector6::Zero();
  Vector6 within_three_sigma = Vector6::Zero();
};

Trial run_trial(const NoiseFitSettings& settings, int seeds) {
  tests::SteadyScript script{.segments = 60, .poses = 6, .period = 0.5};
  const Vector6 truth = stacked(script.noise);
  Trial trial;
  for (int seed = 1; seed <= seeds; ++seed) {
    script.seed = static_cast<std::uint64_t>(seed);
    const std::vector<NoiseGroup> groups{group_of(script)};
    const NoiseFit fit = fit_noise(groups, settings);
    REQUIRE(fit.status == Status::Converged);
    const Vector6 error = stacked(fit.noise) - truth;
    const Vector6 sigma = fit.covariance.diagonal().cwiseSqrt();
    trial.mean += stacked(fit.noise) / seeds;
    trial.mean_squared_error += error.cwiseAbs2() / seeds;
    trial.within_two_sigma += Vector6((error.array().abs() < 2.0 * sigma.array()).cast<double>()) / seeds;
    trial.within_three_sigma += Vector6((error.array().abs() < 3.0 * sigma.array()).cast<double>()) / seeds;
  }
  return trial;
}

TEST_CASE("Fisher scoring recovers slip noise and P0 without bias and as sure as it says, around mean and curve") {
  for (const ScatterCentre centre : {ScatterCentre::Mean, ScatterCentre::Curve}) {
    const Trial trial = run_trial({.centre = centre}, 150);
    const Vector6 truth = stacked(tests::SteadyScript{}.noise);
    CAPTURE(trial.mean.transpose());
    CHECK(((trial.mean - truth).array().abs() < 0.06 * truth.array()).all());
    CAPTURE(trial.within_two_sigma.transpose());
    CHECK(trial.within_two_sigma.minCoeff() > 0.88);  // 0.95 but for the skew of variances
    CHECK(trial.within_three_sigma.minCoeff() > 0.96);
  }
}

TEST_CASE(
    "the thesis's objective finds too large a P0, since the zero bound cuts its wide errors; Fisher scoring does not") {
  const Vector6 truth = stacked(tests::SteadyScript{}.noise);
  const double thesis = run_trial({.objective = NoiseObjective::Thesis}, 800).mean[4] / truth[4];
  const double fisher = run_trial({}, 800).mean[4] / truth[4];
  MESSAGE("lateral P0, mean / truth: thesis ", thesis, ", Fisher ", fisher);
  CHECK(thesis > 1.1);
  CHECK(std::abs(fisher - 1.0) < 0.04);
}

TEST_CASE("noise that is absent is found to be zero within its uncertainty, never negative") {
  const tests::SteadyScript script{
      .noise = {.psd = {4e-4, 0.0, 3e-4}, .start = {1e-4, 1e-4, 0.0}}, .segments = 60, .poses = 6, .period = 0.5};
  const std::vector<NoiseGroup> groups{group_of(script)};
  const NoiseFit fit = fit_noise(groups);
  const Vector6 noise = stacked(fit.noise);
  CHECK(noise.minCoeff() >= 0.0);
  CHECK(noise[1] < 1e-5);
  CHECK(noise[5] < 4e-5);
}

TEST_CASE("a known noise of the measured poses is not taken for slip") {
  tests::SteadyScript script{.segments = 100, .poses = 6, .period = 0.5};
  script.noise.pose = {4e-4, 4e-4, 1e-4};
  const std::vector<NoiseGroup> groups{group_of(script)};
  const NoiseFit fit = fit_noise(groups, {.pose = script.noise.pose});
  const Vector6 error = stacked(fit.noise) - stacked(script.noise);
  CHECK((error.array().abs() < 3.0 * fit.covariance.diagonal().array().sqrt()).all());
}

TEST_CASE("the scatter around the mean is smaller than around a curve that is off, and says when its rank is short") {
  NoiseGroup group = group_of({.segments = 5});
  for (auto& residual : group.residuals) {
    residual.row(0).array() += 0.1;
  }
  CHECK(scatter_matrix(group, ScatterCentre::Curve)(0, 0) > 0.01);
  CHECK(scatter_matrix(group, ScatterCentre::Mean)(0, 0) < 0.005);
  const std::vector<NoiseGroup> five{group};
  CHECK(fit_noise(five).scatter_definite);
  const std::vector<NoiseGroup> three{group_of({.segments = 3})};
  CHECK_FALSE(fit_noise(three).scatter_definite);  // deviations from a mean of three have rank 2
}

TEST_CASE("groups that cannot tell the noise are refused with the reason") {
  NoiseGroup group = group_of({.segments = 3});
  group.residuals.pop_back();
  CHECK_THROWS_WITH_AS(scatter_matrix(group, ScatterCentre::Mean), doctest::Contains("at least three segments"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(fit_noise({}), doctest::Contains("at least one group"), std::invalid_argument);
  group.residuals.assign(4, group.residuals[0]);
  const std::vector<NoiseGroup> duplicates{group};
  CHECK_THROWS_WITH_AS(fit_noise(duplicates), doctest::Contains("duplicates"), std::invalid_argument);
  NoiseGroup terminal = group_of({.segments = 10});
  terminal.times = {3.0};
  for (auto& residual : terminal.residuals) {
    residual = residual.rightCols(1).eval();
  }
  terminal.twist = {.v = 1.0};
  const std::vector<NoiseGroup> at_one_time{terminal};
  CHECK_THROWS_WITH_AS(fit_noise(at_one_time), doctest::Contains("cannot be distinguished"), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
