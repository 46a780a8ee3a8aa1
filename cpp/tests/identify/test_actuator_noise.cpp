// SPDX-License-Identifier: Apache-2.0
// Means of a correlated deviation: the same however they are cut, stationary, and white where they should be.
#include "slipwise/identify/actuator_noise.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace slipwise {
namespace {

const ActuatorNoise kDisturbed{.white = 0.0, .deviation = 4.0, .time_constant = 0.7};

TEST_CASE("means over halves average to the mean over the whole") {
  const std::vector<double> halves{0.0, 0.3, 0.6};
  const std::vector<double> whole{0.0, 0.6};
  const ActuatorNoiseMeans cut = actuator_noise_means(kDisturbed, halves, std::vector<double>{1.0, 1.0});
  const ActuatorNoiseMeans uncut = actuator_noise_means(kDisturbed, whole, std::vector<double>{1.0});
  Eigen::Matrix<double, 2, 3> average;
  average << 0.5, 0.5, 0.0, 0.0, 0.0, 1.0;
  CHECK((average * cut.by_start - uncut.by_start).lpNorm<Eigen::Infinity>() < 1e-14);
  CHECK((average * cut.covariance * average.transpose() - uncut.covariance).lpNorm<Eigen::Infinity>() < 1e-13);
}

TEST_CASE("a deviation that was nominal stays nominal") {
  const std::vector<double> edges{0.0, 0.1, 0.5, 2.0};
  const ActuatorNoiseMeans means = actuator_noise_means(kDisturbed, edges, std::vector<double>{1.0, 1.0, 1.0});
  const Eigen::MatrixXd all = means.covariance + kDisturbed.deviation * means.by_start * means.by_start.transpose();
  CHECK(all(3, 3) == doctest::Approx(kDisturbed.deviation));
  const double spans = 0.4 / kDisturbed.time_constant;  // of the second interval
  const double nominal = 2.0 * kDisturbed.deviation / spans * (1.0 - (1.0 - std::exp(-spans)) / spans);
  CHECK(all(1, 1) == doctest::Approx(nominal));
}

TEST_CASE("white noise is shared by the samples of an interval alone") {
  const ActuatorNoise white{.white = 0.5, .deviation = 0.0, .time_constant = 1.0};
  const std::vector<double> edges{0.0, 0.1, 0.3};
  const ActuatorNoiseMeans means = actuator_noise_means(white, edges, std::vector<double>{2.0, 5.0});
  Eigen::Vector3d expected(0.25, 0.1, 0.0);
  CHECK((means.covariance - Eigen::MatrixXd(expected.asDiagonal())).lpNorm<Eigen::Infinity>() < 1e-15);
}

}  // namespace
}  // namespace slipwise
