// SPDX-License-Identifier: Apache-2.0
// A drive that steers: its lags act on speed and curvature, and the yaw rate follows from both.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/actuator/kinematics.hpp"

namespace slipwise {
namespace {

constexpr double kWheelbase = 0.5;
constexpr ActuatorModel kDrive{
    .time_constant_v = 0.3, .time_constant_omega = 0.15, .delay_v = 0.2, .delay_omega = 0.1, .wheelbase = kWheelbase};

double turn_of(const InputHistory& commands, const ActuatorSpan& window, const ActuatorModel& drive = kDrive) {
  double turn = 0.0;
  for (const ActuatorStep& step : actuator_steps(commands, drive, window).steps) {
    turn += step.turn;
  }
  return turn;
}

/// A channel at `t` after it was told `value` at once at 0, from rest.
double answer(double value, double delay, double lag, double t) {
  return t > delay ? lag_output(0.0, value, lag, t - delay) : 0.0;
}

TEST_CASE("a car that starts with turned wheels turns by the product of its lagged speed and curvature") {
  const InputHistory commands({0.0}, {{.v = 1.2, .vy = 0.0, .omega = 1.2 * 0.8}});
  double expected = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2.0 * (i + 0.5) / kSteps;
    expected += answer(1.2, 0.2, 0.3, t) * answer(0.8, 0.1, 0.15, t) * 2.0 / kSteps;
  }
  const double turn = turn_of(commands, {.start = 0.0, .end = 2.0, .longest_step = 0.01});
  CHECK(turn == doctest::Approx(expected).epsilon(1e-4));
  CHECK(turn_of(commands, {.start = 0.0, .end = 2.0}) == doctest::Approx(expected).epsilon(0.005));
  ActuatorModel turning = kDrive;
  turning.wheelbase = 0.0;
  CHECK(std::abs(turn_of(commands, {.start = 0.0, .end = 2.0}, turning) - expected) > 0.05);
}

TEST_CASE("wheels that are turned at a standstill need no time when the car starts, and none is driven until then") {
  const double curvature = 0.8;
  const BodyTwist stands{.v = kStandingSpeed, .vy = 0.0, .omega = kStandingSpeed * curvature};
  const InputHistory turned({0.0, 3.0}, {stands, {.v = 1.0, .vy = 0.0, .omega = curvature}});
  const InputHistory straight({0.0, 3.0}, {{}, {.v = 1.0, .vy = 0.0, .omega = curvature}});
  double forward = 0.0;
  for (const ActuatorStep& step : actuator_steps(turned, kDrive, {.start = 0.0, .end = 4.0}).steps) {
    forward += step.forward;
    CHECK(step.turn == doctest::Approx(step.forward * curvature).epsilon(0.02));
  }
  CHECK(forward > 0.4);
  CHECK(turn_of(straight, {.start = 0.0, .end = 4.0}) < turn_of(turned, {.start = 0.0, .end = 4.0}));
  CHECK(turn_of(turned, {.start = 0.0, .end = 3.0}) == 0.0);
}

TEST_CASE("a measured drive has the curvature of the commands before; without any its own, where it is not too slow") {
  const InputHistory commands({0.0, 3.0}, {{.v = 1.0, .vy = 0.0, .omega = 0.7}, {}}), none;
  const BodyTwist slow{.v = 0.09, .vy = 0.0, .omega = 0.9}, fast{.v = 0.9, .vy = 0.0, .omega = 0.9};
  const auto curvature = [](const InputHistory& given, const BodyTwist& initial) {
    const ActuatorStep first =
        actuator_steps(given, kDrive, {.start = 3.0, .end = 4.0, .initial = initial}).steps.front();
    return first.turn / first.forward;
  };
  CHECK(curvature(commands, slow) == doctest::Approx(0.7).epsilon(1e-6));
  CHECK(curvature(commands, fast) == doctest::Approx(0.7).epsilon(1e-6));
  CHECK(curvature(none, slow) == 0.0);
  CHECK(curvature(none, fast) == doctest::Approx(1.0).epsilon(1e-9));
}

TEST_CASE("channels of commands are speed and a curvature that wheels can have; of slow measured ones that before") {
  const double sharpest = sharpest_curvature(kWheelbase);
  CHECK(channel_input({.v = 2.0, .vy = 0.0, .omega = 1.0}, kWheelbase) == BodyTwist{.v = 2.0, .vy = 0.0, .omega = 0.5});
  CHECK(channel_input({.v = -2.0, .vy = 0.0, .omega = 1.0}, kWheelbase).omega == -0.5);
  CHECK(channel_input({.v = 0.01, .vy = 0.0, .omega = -1.0}, kWheelbase).omega == -sharpest);
  CHECK(channel_input({.v = 0.0, .vy = 0.0, .omega = 1.0}, kWheelbase) == BodyTwist{});
  CHECK(channel_input({.v = 0.3, .vy = 0.1, .omega = 1.0}, 0.0) == BodyTwist{.v = 0.3, .vy = 0.1, .omega = 1.0});
  const InputHistory seen({0.0, 1.0, 2.0},
                          {{.v = 0.05, .vy = 0.0, .omega = 0.2}, {.v = 1.0, .vy = 0.0, .omega = 0.4}, {.v = 0.0}});
  const InputHistory channels = measured_channels(seen, kWheelbase);
  CHECK(channels.sample(0).omega == 0.0);
  CHECK(channels.sample(1).omega == 0.4);
  CHECK(channels.sample(2).omega == 0.4);
}

}  // namespace
}  // namespace slipwise
