// SPDX-License-Identifier: Apache-2.0
// The learned factor of the noise: it finds the real size, resists outliers, and stays where it is not to learn.
#include <doctest/doctest.h>

#include <random>

#include "slipwise/filter/noise_scale.hpp"

namespace slipwise {
namespace {

const Eigen::Vector3d kExpected(0.04, 0.01, 0.0025);
const Directions kChart = Eigen::Matrix<Eigen::Index, 3, 1>(kAlong, kAcross, kTurn);

TEST_CASE("residuals of any size bring the factor to what they are, over what was expected") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  NoiseScale scale({.forgetting_time = 400.0});
  const Eigen::Vector3d truth(2.0, 0.5, 1.0);
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d unit(normal(random), normal(random), normal(random));
    scale.learn_prediction(
        kChart, {unit.cwiseAbs2().cwiseProduct(truth).cwiseProduct(kExpected), Eigen::Vector3d::Zero(), kExpected});
  }
  CHECK((scale.value().cwiseQuotient(truth) - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff() < 0.25);
}

TEST_CASE("one residual counts at most as much as the settings say, beside those that the shape stands for") {
  const NoiseSettings settings{.prior_segments = 5.0, .largest = 9.0};
  NoiseScale scale(settings);
  scale.learn_prediction(kChart, {Eigen::Vector3d::Constant(1e12), Eigen::Vector3d::Zero(), kExpected});
  CHECK(scale.value().isApprox(Eigen::Vector3d::Constant(1.0 + (9.0 - 1.0) / 6.0)));
}

TEST_CASE("of a squared error, what the parameters leave open is no noise, but a tenth always is") {
  NoiseScale open({.prior_segments = 0.0}), wide({.prior_segments = 0.0});
  open.learn_prediction(kChart, {2.0 * kExpected, 0.5 * kExpected, kExpected});
  CHECK(open.value().isApprox(Eigen::Vector3d::Constant(1.5)));
  wide.learn_prediction(kChart, {2.0 * kExpected, 50.0 * kExpected, kExpected});
  CHECK(wide.value().isApprox(Eigen::Vector3d::Constant(0.2)));
}

TEST_CASE("a noise that is known stays") {
  NoiseScale known({.adapt = false});
  known.learn_prediction(kChart, {4.0 * kExpected, Eigen::Vector3d::Zero(), kExpected});
  CHECK(known.value() == Eigen::Vector3d::Ones());
}

}  // namespace
}  // namespace slipwise
