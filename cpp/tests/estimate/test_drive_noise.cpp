// SPDX-License-Identifier: Apache-2.0
// Means of a wandering deviation: the same however they are cut, stationary, and white where they should be.
#include "slipwise/estimate/drive_noise.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace slipwise {
namespace {

const DriveNoise kWandering{.white = 0.0, .wander = 4.0, .time_constant = 0.7};

TEST_CASE("means over halves average to the mean over the whole") {
  const std::vector<double> halves{0.0, 0.3, 0.6};
  const std::vector<double> whole{0.0, 0.6};
  const DriveNoiseMeans cut = drive_noise_means(kWandering, halves, std::vector<double>{1.0, 1.0});
  const DriveNoiseMeans uncut = drive_noise_means(kWandering, whole, std::vector<double>{1.0});
  Eigen::Matrix<double, 2, 3> average;
  average << 0.5, 0.5, 0.0, 0.0, 0.0, 1.0;
  CHECK((average * cut.by_start - uncut.by_start).lpNorm<Eigen::Infinity>() < 1e-14);
  CHECK((average * cut.covariance * average.transpose() - uncut.covariance).lpNorm<Eigen::Infinity>() < 1e-13);
}

TEST_CASE("a deviation that was usual stays usual") {
  const std::vector<double> edges{0.0, 0.1, 0.5, 2.0};
  const DriveNoiseMeans means = drive_noise_means(kWandering, edges, std::vector<double>{1.0, 1.0, 1.0});
  const Eigen::MatrixXd all = means.covariance + kWandering.wander * means.by_start * means.by_start.transpose();
  CHECK(all(3, 3) == doctest::Approx(kWandering.wander));
  const double spans = 0.4 / kWandering.time_constant;  // of the second interval
  const double usual = 2.0 * kWandering.wander / spans * (1.0 - (1.0 - std::exp(-spans)) / spans);
  CHECK(all(1, 1) == doctest::Approx(usual));
}

TEST_CASE("white noise is shared by the samples of an interval alone") {
  const DriveNoise white{.white = 0.5, .wander = 0.0, .time_constant = 1.0};
  const std::vector<double> edges{0.0, 0.1, 0.3};
  const DriveNoiseMeans means = drive_noise_means(white, edges, std::vector<double>{2.0, 5.0});
  Eigen::Vector3d expected(0.25, 0.1, 0.0);
  CHECK((means.covariance - Eigen::MatrixXd(expected.asDiagonal())).lpNorm<Eigen::Infinity>() < 1e-15);
}

}  // namespace
}  // namespace slipwise
