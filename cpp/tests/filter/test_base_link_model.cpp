// SPDX-License-Identifier: Apache-2.0
// Delays to wheel speeds that are stamped late are no delays to the motion.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "slipwise/filter/base_link_model.hpp"
#include "slipwise/slip/basis.hpp"

namespace slipwise {
namespace {

constexpr Eigen::Index kDelay = 4;  // behind two slips and two time constants
constexpr Eigen::Index kClock = 12;

const MotionModel& sensed() {
  static const MotionModel model(named_basis("edd-2"),
                                 {.dynamics = true, .clock_offset = true, .response = true, .sensor_extrinsics = true});
  return model;
}

Estimate with_offset(double seconds) {
  Estimate estimate{Eigen::VectorXd::Constant(sensed().size(), 0.1),
                    Eigen::MatrixXd::Identity(sensed().size(), sensed().size()) * 1e-4};
  estimate.mean[kDelay] = std::log(0.27);
  estimate.mean[kDelay + 1] = std::log(0.05);
  estimate.mean[kClock] = seconds;
  estimate.covariance(kDelay, kClock) = estimate.covariance(kClock, kDelay) = -0.5e-4;
  return estimate;
}

TEST_CASE("poses that are late change nothing of the robot; the sensor's parameters go") {
  REQUIRE(sensed().parameters()[kDelay].name == "log_delay_v");
  REQUIRE(sensed().parameters()[kClock].name == "clock_offset");
  for (const double seconds : {0.3, 0.0, -0.015}) {
    const Estimate known = with_offset(seconds);
    const KnownModel body = of_base_link(sensed(), known);
    CHECK(body.model.size() == kClock);
    CHECK(body.estimate.mean == known.mean.head(kClock));
    CHECK(body.estimate.covariance == known.covariance.topLeftCorner(kClock, kClock));
  }
}

TEST_CASE("wheel speeds that are late lengthen no delay to the motion, whose deviation knows both") {
  const KnownModel body = of_base_link(sensed(), with_offset(-0.12));
  CHECK(std::exp(body.estimate.mean[kDelay]) == doctest::Approx(0.15));
  const double expected = 0.27 * 0.27 * 1e-4 + 1e-4 - 2.0 * 0.27 * 0.5e-4;  // [s^2] of the sum of both
  const double std = 0.15 * std::sqrt(body.estimate.covariance(kDelay, kDelay));
  CHECK(std == doctest::Approx(std::sqrt(expected)));
  CHECK(std::exp(body.estimate.mean[kDelay + 1]) == doctest::Approx(0.002));  // no delay is below zero
  CHECK(body.estimate.mean.head(kDelay) == with_offset(-0.12).mean.head(kDelay));
}

}  // namespace
}  // namespace slipwise
