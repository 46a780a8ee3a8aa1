// SPDX-License-Identifier: Apache-2.0
// Noise of one period, the tangent between poses, roots of covariances, and what uncertainties are refused.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

#include "sample_bases.hpp"
#include "slipwise/rollout/path_noise.hpp"

namespace slipwise {
namespace {

const MotionModel& sample_motion() {
  static const MotionModel model(named_basis("drive-5"), {});
  return model;
}

UncertainModel sample() {
  return {.model = sample_motion(),
          .parameters = tests::sample_slip(sample_motion().basis(), 3),
          .uncertainty = {.covariance = 0.01 * Eigen::MatrixXd::Identity(5, 5), .noise = {}},
          .setting = {.period = 0.1}};
}

TEST_CASE("the tangent between two poses leads from one to the other") {
  const Pose2 before{.x = 1.0, .y = -2.0, .theta = 0.7};
  for (const double turn : {0.0, 1e-9, 0.3, -2.5, 3.5}) {
    const Eigen::Vector3d tangent(0.4, -0.1, turn);
    const Pose2 after = compose(before, exp(tangent));
    CHECK((period_tangent(before, after) - tangent).norm() < 1e-12);
  }
}

TEST_CASE("a parked robot has no slip noise") {
  const MotionNoise noise{.psd_time = {1, 1, 1}, .psd_motion = {1, 1, 1}, .fraction = {1, 1, 1}};
  const PeriodNoise none = period_noise(Eigen::Vector3d::Zero(), 0.1, noise);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(none.variance[c] == 0.0);
    CHECK(none.constant[c] == 0.0);
  }
}

TEST_CASE("noise of a period grows with time and motion, where turning moves the wheels and driving disturbs the yaw") {
  const MotionNoise noise{.psd_time = {0.1, 0.2, 0.3}, .psd_motion = {1, 2, 3}, .fraction = {0.1, 0.2, 0.3}};
  const PeriodNoise driven = period_noise({0.3, 0.4, -0.2}, 0.5, noise);
  const double wheels = 0.5 + 0.3 * 0.2, turned = 0.2 + 0.5 / 5.0;
  CHECK(driven.variance[0] == doctest::Approx(0.1 * 0.5 + wheels));
  CHECK(driven.variance[1] == doctest::Approx(0.2 * 0.5 + 2 * wheels));
  CHECK(driven.variance[2] == doctest::Approx(0.3 * 0.5 + 3 * turned));
  CHECK(driven.constant[1] == doctest::Approx(0.2 * wheels));
  CHECK(driven.constant[2] == doctest::Approx(0.3 * turned));
}

TEST_CASE("the drive alone has no slip") {
  CHECK(sample().parameters.norm() > 0.0);
  const RolloutProgram program = drive_alone(sample());
  for (const SlipProduct& product : program.slip().products) {
    const bool drive =
        &product == &program.slip().products[kProductV] || &product == &program.slip().products[kProductOmega];
    for (const double fraction : product.fraction) {
      CHECK((fraction == 0.0 || (drive && fraction == 1.0)));
    }
  }
}

TEST_CASE("an uncertainty that does not fit its model or holds no number is refused") {
  CHECK_NOTHROW(check_uncertainty(sample()));
  UncertainModel small = sample();
  small.uncertainty.covariance = Eigen::MatrixXd::Identity(4, 4);
  CHECK_THROWS_WITH_AS(check_uncertainty(small), "the covariance is 4 by 4 for 5 parameters", std::invalid_argument);
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    UncertainModel grown = sample();
    grown.uncertainty.inflation = wrong;
    CHECK_THROWS_AS(check_uncertainty(grown), std::invalid_argument);
    UncertainModel scaled = sample();
    scaled.uncertainty.scale[1] = wrong;
    CHECK_THROWS_AS(check_uncertainty(scaled), std::invalid_argument);
  }
  UncertainModel open = sample();
  open.uncertainty.covariance(2, 3) = std::nan("");
  CHECK_THROWS_AS(check_uncertainty(open), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
