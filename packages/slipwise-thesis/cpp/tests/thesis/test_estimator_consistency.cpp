// SPDX-License-Identifier: Apache-2.0
// Which estimator is as sure as it should be? NEES of all that have a covariance, same truth and noise.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/thesis/estimator.hpp"

namespace slipwise {
namespace {

constexpr int kRuns = 20;
constexpr double kSpread = 0.05;  // of the true parameters, and of the prior

/// Windows of `length` poses that start `stride` poses apart, from poses measured every step.
std::vector<Segment> windows_of(const std::vector<Segment>& steps, std::size_t length, std::size_t stride) {
  std::vector<Pose2> poses{{}};
  for (const Segment& step : steps) {
    poses.push_back(compose(poses.back(), motion_of(step.measured)));
  }
  std::vector<Segment> windows;
  for (std::size_t i = 0; i + length < poses.size(); i += stride) {
    const Pose2 moved = between(poses[i], poses[i + length]);
    windows.push_back({.start = steps[i].start, .end = steps[i + length - 1].end, .measured = measured_pose(moved)});
  }
  return windows;
}

double nees(const std::string& name, const MotionNoise& noise, std::size_t stride) {
  const MotionModel model(named_basis("odd-even-10"), {});
  const Estimate prior{Eigen::VectorXd::Zero(10), kSpread * kSpread * Eigen::MatrixXd::Identity(10, 10)};
  EstimatorSettings settings;
  settings.noise = noise;
  settings.iekf = {.huber = 1e9, .gate = 1e18};
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(2000 + static_cast<std::uint64_t>(run));
    std::normal_distribution<double> normal(0.0, kSpread);
    Eigen::VectorXd truth(10);
    for (double& value : truth) {
      value = normal(random);
    }
    const auto drive =
        tests::simulate_drive(model, truth, {.seed = random(), .windows = 1000, .window = 0.25, .noise = noise});
    Estimator estimator = make_estimator(name, model, prior, settings);
    for (const Segment& segment : windows_of(drive.segments, 20, stride)) {
      estimator.learn(drive.inputs, segment);
    }
    const Estimate estimate = estimator.estimate();
    const Eigen::VectorXd error = estimate.mean - truth;
    sum += error.dot(Cholesky(estimate.covariance).solve(error)) / 10.0 / kRuns;
  }
  MESSAGE(name << ": NEES/m = " << sum);
  return sum;
}

/// Half the width of the 95 % band of a chi-square mean over all runs and parameters, by its normal limit.
const double kBand = 1.96 * std::sqrt(2.0 / (kRuns * 10.0));

const MotionNoise kBoth{.psd_time = {2e-4, 2e-4, 4e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.005};
const MotionNoise kMostlyPose{.psd_time = {1e-5, 1e-5, 1e-5}, .pose_std_xy = 0.03, .pose_std_yaw = 0.01};

TEST_CASE("iekf and delayed-state are consistent on disjoint segments") {
  CHECK(std::abs(nees("iekf", kBoth, 20) - 1.0) < kBand);
  CHECK(std::abs(nees("delayed-state", kBoth, 20) - 1.0) < kBand);
}

TEST_CASE("delayed-state stays consistent where shared pose noise dominates") {
  CHECK(std::abs(nees("delayed-state", kMostlyPose, 20) - 1.0) < kBand);
}

TEST_CASE("the thesis's filter counts each datum many times and is far too sure") {
  CHECK(nees("ekf-thesis", kBoth, 1) > 1.0 + 10.0 * kBand);
}

}  // namespace
}  // namespace slipwise
