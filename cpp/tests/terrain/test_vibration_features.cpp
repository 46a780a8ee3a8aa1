// SPDX-License-Identifier: Apache-2.0
// Log powers in bands say at which frequency which axis shakes.
#include "slipwise/terrain/vibration_features.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace slipwise {
namespace {

TEST_CASE("a tone shows in its band of its axis") {
  const VibrationBands bands(100.0);
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(500, kImuAxes);
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    samples(i, 2) = std::sin(2.0 * std::numbers::pi * 5.0 * static_cast<double>(i) / 100.0);
  }
  Eigen::Index loudest = 0;
  const Eigen::VectorXd features = bands.features(samples);
  features.maxCoeff(&loudest);
  REQUIRE(bands.edges().size() == 12);
  CHECK(loudest == 2 * 12 + 2);
  CHECK(bands.edges()[2][0] == 4.0);
  CHECK(features[0] == doctest::Approx(std::log(1e-9)));
}

TEST_CASE("a low rate has fewer bands, and none has no features") {
  CHECK(VibrationBands(50.0).edges().size() == 8);
  CHECK(VibrationBands(0.0).features(Eigen::MatrixXd::Zero(5, kImuAxes)).size() == 0);
}

TEST_CASE("too few samples, other axes and a rate that is none are refused") {
  const VibrationBands bands(100.0);
  CHECK_THROWS_AS((void)bands.features(Eigen::MatrixXd::Zero(99, kImuAxes)), std::invalid_argument);
  CHECK_THROWS_AS((void)bands.features(Eigen::MatrixXd::Zero(500, 3)), std::invalid_argument);
  CHECK_THROWS_AS(VibrationBands(-1.0), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
