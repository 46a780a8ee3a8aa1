// SPDX-License-Identifier: Apache-2.0
// Limits of the drive: what passes, how ramps run, and that nothing comes from later commands.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "slipwise/actuator/actuator_output.hpp"
#include "slipwise/actuator/command_limiter.hpp"
#include "slipwise/actuator/command_limits.hpp"

namespace slipwise {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

InputHistory commands_at(const std::vector<double>& t, const std::vector<double>& v, const std::vector<double>& omega) {
  const std::vector<double> vy(t.size(), 0.25);
  return {t, v, vy, omega};
}

/// Integral of the speed from the first sample to `until`.
double distance(const InputHistory& inputs, double until) {
  double sum = 0.0;
  for (std::size_t i = 0; i < inputs.size() && inputs.time(i) < until; ++i) {
    const double next = i + 1 < inputs.size() ? std::min(inputs.time(i + 1), until) : until;
    sum += inputs.sample(i).v * (next - inputs.time(i));
  }
  return sum;
}

TEST_CASE("without limits the commands pass as they are") {
  const InputHistory commands = commands_at({0.0, 1.0}, {1.0, -2.0}, {0.5, 0.0});
  const InputHistory limited = limited_inputs(commands, {});
  REQUIRE(limited.size() == commands.size());
  CHECK(limited.sample(1) == commands.sample(1));
}

TEST_CASE("a dead-band blocks what is slower and passes the rest whole; a saturation cuts; both signs alike") {
  const CommandLimits limits{.speed = {.dead_band = 0.2, .saturation = 1.0}};
  const InputHistory limited =
      limited_inputs(commands_at({0, 1, 2, 3, 4}, {0.1, 0.3, 5.0, -0.19, -7.0}, {1, 1, 1, 1, 1}), limits);
  CHECK(limited.at(0.5).v == 0.0);
  CHECK(limited.at(1.5).v == 0.3);
  CHECK(limited.at(2.5).v == 1.0);
  CHECK(limited.at(3.5).v == 0.0);
  CHECK(limited.at(4.5).v == -1.0);
  CHECK(limited.at(4.5).omega == 1.0);
  CHECK(limited.at(4.5).vy == 0.25);
}

TEST_CASE("ramps keep the distance exactly, through zero with braking first") {
  const CommandLimits limits{.speed = {.slew_rate_up = 2.0, .slew_rate_down = 4.0}};
  const InputHistory limited = limited_inputs(commands_at({0.0, 3.0}, {1.0, -1.0}, {0.0, 0.0}), limits);
  CHECK(distance(limited, 3.0) == doctest::Approx(3.0 - 0.25));  // 0.5 s up to 1 m/s
  // 0.25 s down to zero, 0.5 s up to -1 m/s.
  CHECK(distance(limited, 5.0) == doctest::Approx(2.75 + 0.125 - 0.25 - 1.25));
  CHECK(limited.at(3.2).v > 0.0);
  CHECK(limited.at(3.3).v < 0.0);
}

TEST_CASE("a ramp cut short by a command errs in distance by no more than stated") {
  const double rate = 2.0;
  const double piece = 0.02;
  const CommandLimits limits{.speed = {.slew_rate_up = rate, .slew_rate_down = rate}};
  const InputHistory limited = limited_inputs(commands_at({0.0, 0.33}, {1.0, 0.0}, {0.0, 0.0}), limits, piece);
  CHECK(std::abs(distance(limited, 0.33) - 0.5 * rate * 0.33 * 0.33) <= rate * piece * piece / 8.0 + 1e-12);
}

TEST_CASE("commands at equal intervals are cut exactly, from the second on") {
  const CommandLimits limits{.speed = {.slew_rate_up = 2.0, .slew_rate_down = 2.0}};
  std::vector<double> t, v, omega(12, 0.0);
  for (int k = 0; k < 12; ++k) {
    t.push_back(0.05 * k);
    v.push_back(k < 6 ? 5.0 : -5.0);
  }
  const InputHistory limited = limited_inputs(commands_at(t, v, omega), limits);
  const double reached = distance(limited, 0.55) - distance(limited, 0.05);
  CHECK(reached == doctest::Approx(0.3 * 0.3 - 0.05 * 0.05 + 0.3 * 0.3 - 0.05 * 0.05).epsilon(1e-12));
}

TEST_CASE("a drive that was commanded something for long gives what its limits leave of it") {
  const CommandLimits limits{
      .speed = {.saturation = 0.5, .slew_rate_up = 1.0}, .side = {.saturation = 0.6}, .wheel_separation = 0.5};
  CommandLimiter limiter(limits);
  limiter.settle({.v = 3.0, .vy = 0.0, .omega = 1.0});
  CHECK(limiter.seconds_left() == 0.0);
  CHECK(limiter.target().v == doctest::Approx(0.5 * (0.25 + 0.6)));
  CHECK(limiter.mean_over(0.1, 0.1).v == limiter.target().v);
  limiter.place({.v = 0.3, .vy = 0.0, .omega = 0.0});
  CHECK(limiter.mean_over(0.02, 0.02).v == doctest::Approx(0.3));
}

TEST_CASE("sides are limited each for itself, behind gains") {
  const CommandLimits limits{.side = {.saturation = 1.0}, .wheel_separation = 0.5, .gain_v = 2.0, .gain_omega = 0.5};
  const InputHistory limited = limited_inputs(commands_at({0.0}, {0.4}, {4.0}), limits);
  // Asked: 0.8 -+ 0.5: left 0.3, right 1.3, cut to 1.
  CHECK(limited.at(0.0).v == doctest::Approx(0.65));
  CHECK(limited.at(0.0).omega == doctest::Approx(1.4));
}

TEST_CASE("what comes out until some moment does not depend on later commands") {
  const CommandLimits limits{.speed = {.dead_band = 0.1, .saturation = 1.0, .slew_rate_up = 0.7, .slew_rate_down = 1.3},
                             .side = {.saturation = 0.8, .slew_rate_up = 0.9, .slew_rate_down = 1.1},
                             .wheel_separation = 0.6};
  const InputHistory whole =
      limited_inputs(commands_at({0, 0.3, 0.71, 1.4}, {0.5, -0.8, 1.5, 0.0}, {1, -1, 0.3, 0}), limits);
  const InputHistory early = limited_inputs(commands_at({0, 0.3}, {0.5, -0.8}, {1, -1}), limits);
  for (double t = 0.0; t < 0.71; t += 0.003) {
    CHECK(whole.at(t) == early.at(t));
  }
}

TEST_CASE("behind a lag the rates are those of the drive itself, whose lag is the same") {
  const double lag = 0.3, up = 0.5, down = 0.9;
  const CommandLimits limits{.speed = {.slew_rate_up = up, .slew_rate_down = down, .slew_rate_lag = lag}};
  const std::vector<double> t{0.0, 2.5, 3.1, 6.0, 9.0}, v{1.0, -0.8, 0.1, 0.0, -2.0};
  const std::vector<double> nothing(t.size(), 0.0);
  const InputHistory commands(t, v, nothing, nothing);
  const InputHistory limited = limited_inputs(commands, limits);
  std::vector<double> times;
  for (int k = 0; k < 600; ++k) {
    times.push_back(0.02 * k);
  }
  const ActuatorOutput drive = actuator_output(limited, {.time_constant_v = lag}, times, {});
  double speed = 0.0, worst = 0.0;
  constexpr double kStep = 1e-4;
  for (std::size_t k = 1; k < times.size(); ++k) {
    for (double now = times[k - 1] + 0.5 * kStep; now < times[k]; now += kStep) {
      const double gap = commands.at(now).v - speed;
      const double most = gap * speed < 0.0 ? down : up;
      speed += kStep * std::clamp(gap / lag, -most, most);
    }
    worst = std::max(worst, std::abs(drive.v[k] - speed));
  }
  CHECK(worst < 5e-4);
}

TEST_CASE("limits that make no sense are refused with the axis and what to give") {
  const InputHistory commands = commands_at({0.0}, {1.0}, {0.0});
  CHECK_THROWS_WITH_AS(limited_inputs(commands, {.yaw_rate = {.saturation = -1.0}}),
                       doctest::Contains("yaw rate axis's saturation"), std::invalid_argument);
  CHECK_THROWS_AS(limited_inputs(commands, {.speed = {.dead_band = -0.1}}), std::invalid_argument);
  CHECK_THROWS_AS(limited_inputs(commands, {.speed = {.slew_rate_up = 0.0}}), std::invalid_argument);
  CHECK_THROWS_AS(limited_inputs(commands, {.side = {.slew_rate_down = std::nan("")}}), std::invalid_argument);
  CHECK_THROWS_AS(limited_inputs(commands, {.side = {.saturation = 1.0}, .wheel_separation = 0.0}),
                  std::invalid_argument);
  CHECK_THROWS_AS(limited_inputs(commands, {.speed = {.dead_band = kNoLimit}}), std::invalid_argument);
}

TEST_CASE("the actuator's output is that of its drive steps") {
  const InputHistory inputs = commands_at({0.0, 0.5, 1.1}, {1.0, -0.5, 0.7}, {0.2, 0.9, -0.4});
  const ActuatorModel actuator{
      .time_constant_v = 0.3, .time_constant_omega = 0.2, .delay_v = 0.13, .delay_omega = 0.07, .gain_v = 0.9};
  const std::vector<double> times{0.0, 2.0, 2.0005};
  const ActuatorOutput output = actuator_output(inputs, actuator, times, {});
  const ActuatorSteps steps = actuator_steps(inputs, actuator, {.start = 2.0, .end = 2.0005});
  CHECK(output.v[1] == doctest::Approx(steps.steps[0].forward / 0.0005).epsilon(1e-3));
  CHECK(output.omega[1] == doctest::Approx(steps.steps[0].turn / 0.0005).epsilon(1e-3));
}

}  // namespace
}  // namespace slipwise
