// SPDX-License-Identifier: Apache-2.0
// The ramp of one axis, and the four axes of a drive together: how long they take, and what they give meanwhile.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

#include "slipwise/actuator/command_limiter.hpp"

namespace slipwise {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr AxisLimits kAxis{.dead_band = 0.1, .saturation = 2.0, .slew_rate_up = 1.0, .slew_rate_down = 4.0};

AxisRamp ramp_at(const AxisLimits& limits, double state, double command) {
  AxisRamp ramp(limits);
  ramp.aim(command);
  ramp.place(state);
  return ramp;
}

TEST_CASE("an axis brakes to zero and then speeds up the other way, each at its own rate") {
  const AxisRamp ramp = ramp_at(kAxis, 1.0, -2.0);
  CHECK(ramp.seconds_to(-2.0) == doctest::Approx(1.0 / 4.0 + 2.0 / 1.0));
  AxisRamp moving = ramp;
  // 0.125 m while it brakes, then -0.5 * 0.25^2 m.
  CHECK(moving.mean_over(0.5, 0.5) * 0.5 == doctest::Approx(0.125 - 0.03125));
  CHECK(moving.state() == doctest::Approx(-0.25));
}

TEST_CASE("the mean over a piece is that of its parts") {
  for (const double command : {2.0, 0.5, 0.05, -2.0}) {
    AxisRamp whole = ramp_at(kAxis, 1.0, command);
    AxisRamp parts = whole;
    const double distance = whole.mean_over(0.6, 0.6) * 0.6;
    double sum = 0.0;
    for (const double seconds : {0.1, 0.35, 0.15}) {
      sum += parts.mean_over(seconds, seconds) * seconds;
    }
    CHECK(sum == doctest::Approx(distance).epsilon(1e-12));
    CHECK(parts.state() == doctest::Approx(whole.state()).epsilon(1e-12));
  }
}

TEST_CASE("a piece that is cut short keeps the mean of the whole, and the axis stands where the cut was") {
  AxisRamp cut = ramp_at(kAxis, 0.0, 2.0);
  AxisRamp whole = cut;
  CHECK(cut.mean_over(0.4, 0.1) == doctest::Approx(whole.mean_over(0.4, 0.4)));
  CHECK(cut.state() == doctest::Approx(0.1));
}

TEST_CASE("an axis without rates is there at once, and one that only brakes slowly speeds up at once") {
  AxisRamp free({.saturation = 2.0});
  free.aim(5.0);
  CHECK(free.state() == 2.0);
  AxisRamp coasting({.slew_rate_down = 0.5});
  coasting.aim(1.0);
  CHECK(coasting.state() == 1.0);
  CHECK_FALSE(coasting.ramps_to(2.0));
  CHECK(coasting.ramps_to(0.0));
  coasting.aim(-1.0);  // zero comes first, and takes its time
  CHECK(coasting.state() == 1.0);
  CHECK(coasting.seconds_to(-1.0) == doctest::Approx(2.0));
}

TEST_CASE("behind a lag an axis is given no more than its rate asks, and its target once it is near") {
  AxisRamp ramp = ramp_at({.slew_rate_up = 0.5, .slew_rate_down = 2.0, .slew_rate_lag = 0.3}, 0.0, 1.0);
  CHECK(ramp.ramps_to(1.0));
  CHECK_FALSE(ramp.ramps_to(0.15));  // 0.5 m/s^2 is what the lag alone makes of that
  ramp.mean_over(0.1, 0.1);
  CHECK(ramp.state() == doctest::Approx(0.05));
  ramp.mean_over(0.1, 0.04);  // the rest is cut off: a lag goes most of the way at first
  CHECK(ramp.state() > 0.05 + 0.04 * 0.5);
  ramp.place(0.9);
  CHECK(ramp.seconds_to(1.0) == 0.0);
  CHECK(ramp.mean_over(0.3, 0.3) == 1.0);
  CHECK(ramp.state() == doctest::Approx(1.0 - 0.1 * std::exp(-1.0)));
  ramp.place(0.1);
  ramp.aim(-1.0);  // 0.05 s to zero, and 0.05 s at 0.5 m/s^2
  ramp.mean_over(0.1, 0.1);
  CHECK(ramp.state() == doctest::Approx(-0.025));
}

TEST_CASE("after the seconds that it says are left, a drive gives its target") {
  const CommandLimits limits{.speed = {.slew_rate_up = 1.0, .slew_rate_down = 2.0},
                             .yaw_rate = {.slew_rate_up = 1.5, .slew_rate_down = 1.5},
                             .side = {.saturation = 1.2, .slew_rate_up = 0.8, .slew_rate_down = 0.8},
                             .wheel_separation = 0.6};
  CommandLimiter limiter(limits);
  limiter.settle({.v = -0.5, .vy = 0.0, .omega = 0.2});
  limiter.tell({.v = 1.0, .vy = 0.3, .omega = -1.0});
  CHECK(limiter.ramps());
  const double left = limiter.seconds_left();
  CHECK(left > 0.5 / 2.0 + 1.0 / 1.0);
  constexpr int kPieces = 400;
  for (int i = 0; i < kPieces; ++i) {
    limiter.mean_over(1.1 * left / kPieces, 1.1 * left / kPieces);
  }
  CHECK(limiter.seconds_left() == doctest::Approx(0.0));
  const BodyTwist given = limiter.mean_over(0.1, 0.1);
  CHECK(given.v == doctest::Approx(limiter.target().v));
  CHECK(given.omega == doctest::Approx(limiter.target().omega));
  CHECK(given.vy == 0.3);
}

TEST_CASE("a drive that is placed at what it gives goes on giving it, also behind gains of its sides") {
  const CommandLimits limits{
      .side = {.slew_rate_up = 1.0, .slew_rate_down = 1.0}, .wheel_separation = 0.5, .gain_v = 0.8, .gain_omega = 0.5};
  CommandLimiter limiter(limits);
  limiter.place({.v = 0.7, .vy = 0.0, .omega = 0.3});
  CHECK(limiter.seconds_left() == doctest::Approx(0.0));
  const BodyTwist given = limiter.mean_over(0.2, 0.2);
  CHECK(given.v == doctest::Approx(0.7));
  CHECK(given.omega == doctest::Approx(0.3));
}

TEST_CASE("sides at their top keep what is left of speed and turn") {
  const CommandLimits limits{.side = {.saturation = 1.0}, .wheel_separation = 1.0};
  const BodyTwist given = settled(limits, {.v = 0.8, .vy = 0.0, .omega = 1.0});  // sides 0.3 and 1.3
  CHECK(given.v == doctest::Approx(0.65));
  CHECK(given.omega == doctest::Approx(0.7));
}

TEST_CASE("a limiter of limits that are none is refused") {
  CHECK_THROWS_AS(CommandLimiter({.speed = {.saturation = -1.0}}), std::invalid_argument);
  CHECK_THROWS_AS(settled({.side = {.saturation = 1.0}, .wheel_separation = 0.0}, {}), std::invalid_argument);
  CHECK_THROWS_AS(settled({.yaw_rate = {.slew_rate_up = 0.0}}, {}), std::invalid_argument);
  CHECK(settled({.speed = {.saturation = kNone}}, {.v = 9.0}).v == 9.0);
}

}  // namespace
}  // namespace slipwise
