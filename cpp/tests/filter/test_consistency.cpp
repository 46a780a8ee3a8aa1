// SPDX-License-Identifier: Apache-2.0
// Is the filter as sure as it should be? Normalised estimation error squared (NEES) over seeded runs with known truth.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <string>

#include "simulated_drive.hpp"
#include "slipwise/filter/iekf.hpp"

namespace slipwise {
namespace {

constexpr int kRuns = 20;

struct Consistency {
  double nees_per_parameter;  ///< mean over runs; 1 where the reported covariance is right
  double nis_per_dimension;   ///< mean over all windows but each run's first ten
};

/// Truth is drawn from the prior, so that NEES is chi-square also along directions that the drive does not excite.
Consistency measure(const std::string& basis, double fraction, tests::SimulationSettings settings) {
  const MotionModel model(named_basis(basis), {});
  const Estimate prior{Eigen::VectorXd::Zero(model.size()),
                       fraction * fraction * Eigen::MatrixXd::Identity(model.size(), model.size())};
  Consistency sum{};
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(1000 + static_cast<std::uint64_t>(run));
    std::normal_distribution<double> normal(0.0, fraction);
    Eigen::VectorXd truth(model.size());
    for (double& value : truth) {
      value = normal(random);
    }
    settings.seed = random();
    const auto drive = tests::simulate_drive(model, truth, settings);
    Estimate estimate = prior;
    for (std::size_t i = 0; i < drive.segments.size(); ++i) {
      const Segment& segment = drive.segments[i];
      const Eigen::Matrix3d noise = tests::window_noise(model, estimate.mean, drive.inputs, segment, settings.noise);
      const auto update = iekf_update(model, estimate, drive.inputs, segment, noise, {.huber = 1e9, .gate = 1e18});
      estimate = update.estimate;
      sum.nis_per_dimension +=
          i >= 10 ? update.nis / 3.0 / static_cast<double>(drive.segments.size() - 10) / kRuns : 0.0;
    }
    const Eigen::VectorXd error = estimate.mean - truth;
    sum.nees_per_parameter +=
        error.dot(estimate.covariance.llt().solve(error)) / static_cast<double>(model.size()) / kRuns;
  }
  return sum;
}

/// Half the width of the 95 % band of a chi-square mean over all runs and parameters, by its normal limit.
double band(double dimensions) { return 1.96 * std::sqrt(2.0 / (kRuns * dimensions)); }

const MotionNoise kBoth{.psd_time = {2e-4, 2e-4, 4e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.005};

void check_consistent(const Consistency& got, double parameters) {
  MESSAGE("NEES/m = " << got.nees_per_parameter << ", NIS/3 = " << got.nis_per_dimension);
  CHECK(std::abs(got.nees_per_parameter - 1.0) < band(parameters));
}

TEST_CASE("odd-even-10 is consistent under slip noise and pose noise") {
  check_consistent(measure("odd-even-10", 0.05, {.windows = 60, .noise = kBoth}), 10.0);
}

TEST_CASE("thesis-15 is consistent under slip noise and pose noise") {
  check_consistent(measure("thesis-15", 0.02, {.windows = 60, .noise = kBoth}), 15.0);
}

}  // namespace
}  // namespace slipwise
