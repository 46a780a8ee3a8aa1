// SPDX-License-Identifier: Apache-2.0
// Turns of a gyro, and its bias from standing still and from courses.
#include "slipwise/online/gyro_buffer.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <variant>

namespace slipwise {
namespace {

constexpr double kBias = 0.013;

/// A gyro with a bias on a robot that turns ever faster from `begin` to `end` [s].
GyroBuffer turning(double begin, double end, double acceleration) {
  GyroBuffer gyro;
  for (double t = begin; t < end; t += 0.1) {
    gyro.push({t, acceleration * (t - begin) + kBias});
  }
  return gyro;
}

InputBuffer inputs_until(double end, double v) {
  InputBuffer inputs(0.5);
  for (double t = -1.0; t < end; t += 0.1) {
    inputs.push({t, {v, 0.0, 0.0}});
  }
  return inputs;
}

TEST_CASE("a turn is the integral of the yaw rate, and unknown where samples are missing") {
  const GyroBuffer gyro = turning(0.0, 5.0, 0.2);
  const auto turn = gyro.turn(1.03, 3.07);
  REQUIRE(turn);
  CHECK(turn->angle == doctest::Approx(0.1 * (3.07 * 3.07 - 1.03 * 1.03) + kBias * 2.04).epsilon(1e-9));
  CHECK(turn->std > 0.02 * 2.04);  // the bias is not known yet
  const auto pieces = gyro.turns(1.03, 3.07, 3);
  REQUIRE(pieces);
  CHECK(pieces->z.sum() == doctest::Approx(turn->angle));
  CHECK(pieces->z[2] == doctest::Approx(gyro.turn(2.39, 3.07)->angle));
  const auto& covariance = std::get<YawRateSensor>(pieces->sensor.kind).covariance;
  CHECK(covariance.sum() == doctest::Approx(turn->std * turn->std));
  CHECK(covariance(0, 2) > 0.5 * covariance(0, 0));  // of an unknown bias
  CHECK_FALSE(gyro.turns(1.0, 6.0, 3));
  CHECK_FALSE(gyro.turn(1.0, 6.0));
  CHECK_FALSE(gyro.turn(-1.0, 1.0));
  GyroBuffer broken;
  broken.push({0.0, 0.0});
  broken.push({1.0, 0.0});
  CHECK_FALSE(broken.turn(0.2, 0.8));
}

TEST_CASE("the bias is what a gyro says while the inputs stand still") {
  GyroBuffer gyro = turning(0.0, 30.0, 0.0);
  const InputBuffer still = inputs_until(30.0, 0.0);
  const InputBuffer driven = inputs_until(30.0, 1.0);
  for (double t = 0.5; t < 25.0; t += 0.5) {
    gyro.see_inputs(t, driven, 0.02);
  }
  CHECK(gyro.bias() == 0.0);
  for (double t = 25.0; t < 30.0; t += 0.5) {
    gyro.see_inputs(t, still, 0.02);
  }
  CHECK(gyro.bias() == doctest::Approx(kBias).epsilon(0.02));
  CHECK(gyro.bias_std() < 2e-3);
  CHECK(gyro.turn(5.0, 7.0)->angle == doctest::Approx(0.0).epsilon(1e-3));
  CHECK(gyro.turn(5.0, 7.0)->std < 0.01);
}

TEST_CASE("the bias is what a gyro turns more than the course") {
  GyroBuffer gyro = turning(0.0, 200.0, 0.0);
  for (double t = 0.0; t < 199.0; t += 0.5) {
    gyro.see_course({.t = t, .x = t, .y = 0.0, .yaw = 0.05 * std::sin(t), .position = true});
  }
  CHECK(gyro.bias() == doctest::Approx(kBias).epsilon(0.3));
  CHECK(gyro.bias_std() < 4e-3);
  gyro.restart();
  CHECK(gyro.bias() == doctest::Approx(kBias).epsilon(0.3));
  CHECK_FALSE(gyro.turn(5.0, 7.0));
}

}  // namespace
}  // namespace slipwise
