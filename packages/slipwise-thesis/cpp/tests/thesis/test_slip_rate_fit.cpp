// SPDX-License-Identifier: Apache-2.0
// Slip rates of simulated groups: recovery, coverage over seeds, the gain of weights and of the third channel,
// refusals.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "slipwise/thesis/slip_rate_fit.hpp"
#include "steady_group.hpp"

namespace slipwise {
namespace {

double squared_distance(const SlipRateFit& fit, const Eigen::Vector3d& truth) {
  const Eigen::Vector3d error = fit.slip - truth;
  return error.dot(fit.covariance.llt().solve(error));
}

TEST_CASE("without noise the slip rates are recovered to rounding") {
  for (const BodyTwist& command : {BodyTwist{.v = 0.5, .omega = 0.25}, {.v = -1.0}, {.omega = 1.5}}) {
    const tests::SteadyScript script{.command = command, .noise = {}, .segments = 2};
    const SlipRateFit fit = fit_slip_rates(tests::simulate_group(script));
    CHECK(fit.status == Status::Converged);
    CHECK((fit.slip - script.slip).norm() < 1e-9);
    CHECK(fit.rms.norm() < 1e-9);
  }
}

TEST_CASE("slip rates are covered by three sigma and by their 90 % ellipse over many seeds, with and without weights") {
  const tests::SteadyScript script{
      .noise = {.psd = {4e-4, 2e-4, 3e-4}, .start = {1e-4, 1e-4, 4e-4}, .pose = {1e-6, 1e-6, 1e-6}}};
  constexpr int kSeeds = 200;
  for (const bool weighted : {false, true}) {
    CAPTURE(weighted);
    int within_ellipse = 0;
    int within_three_sigma = 0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      tests::SteadyScript drawn = script;
      drawn.seed = static_cast<std::uint64_t>(seed + 1);
      SlipRateSettings settings;
      if (weighted) {
        settings.noise = script.noise;
      }
      const SlipRateFit fit = fit_slip_rates(tests::simulate_group(drawn), settings);
      within_ellipse += squared_distance(fit, script.slip) < 6.251 ? 1 : 0;
      const Eigen::Vector3d sigma = fit.covariance.diagonal().cwiseSqrt();
      within_three_sigma += ((fit.slip - script.slip).array().abs() < 3.0 * sigma.array()).all() ? 1 : 0;
    }
    CHECK(within_ellipse >= 160);  // 180 +- 4.2; the sandwich of 30 segments has t-like tails
    CHECK(within_ellipse <= 193);
    CHECK(within_three_sigma >= 190);
  }
}

TEST_CASE("headings of more than a turn are compared on the right turn") {
  const tests::SteadyScript script{.command = {.omega = 4.0}, .slip = {0.0, 0.0, -1.9}, .noise = {}, .segments = 2};
  auto group = tests::simulate_group(script);
  CHECK(group[0].poses.back().theta > 6.0);
  CHECK((fit_slip_rates(group).slip - script.slip).norm() < 1e-8);
}

TEST_CASE("segments that make no path are refused") {
  auto group = tests::simulate_group({.segments = 2});
  group[1].times.resize(1);
  group[1].poses.resize(1);
  CHECK_THROWS_WITH_AS(fit_slip_rates(group), doctest::Contains("segment 1 needs at least two poses"),
                       std::invalid_argument);
  group = tests::simulate_group({.segments = 2});
  group[0].times[1] = 0.0;
  CHECK_THROWS_WITH_AS(fit_slip_rates(group), doctest::Contains("increase"), std::invalid_argument);
  group = tests::simulate_group({.segments = 2});
  CHECK_THROWS_WITH_AS(fit_slip_rates(group, {.noise = SteadyNoise{}}), doctest::Contains("every channel needs some"),
                       std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
