// SPDX-License-Identifier: Apache-2.0
// What the limits gave before a rollout's start, piece by piece.
#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "slipwise/rollout/limited_commands.hpp"

namespace slipwise {
namespace {

RolloutProgram program_of(const CommandLimits& limits) {
  return {MotionModel(named_basis("edd-2"), {}), Eigen::Vector2d(0.1, -0.1), {.period = 0.1, .limits = limits}};
}

const CommandLimits kRamps{.speed = {.saturation = 1.0, .slew_rate_up = 1.0, .slew_rate_down = 1.0}};

TEST_CASE("without commands before the start the limits give what the drive does") {
  const LimitedStart start = limited_start(program_of(kRamps), {}, {.v = 0.6, .omega = -0.2});
  CHECK(start.limiter.state()[0] == 0.6);
  CHECK(start.at(-1).v == 0.6);
  CHECK(start.at(-100).omega == -0.2);
}

TEST_CASE("the oldest command was held for long, within its limits") {
  const std::array past{DriveCommand{.v = 5.0, .omega = 0.3}};
  const LimitedStart start = limited_start(program_of(kRamps), past, {});
  CHECK(start.limiter.state()[0] == 1.0);
  CHECK(start.at(-1).v == 1.0);
  CHECK(start.at(-50).omega == 0.3);
}

TEST_CASE("each command is cut in pieces along whose means its ramp runs") {
  const RolloutProgram program = program_of(kRamps);
  REQUIRE(program.pieces() > 1);
  const std::array past{DriveCommand{}, DriveCommand{.v = 1.0}, DriveCommand{.v = 1.0}};
  const LimitedStart start = limited_start(program, past, {});
  REQUIRE(start.given.size() == 3 * program.pieces() + 1);
  CHECK(start.limiter.state()[0] == doctest::Approx(0.2));  // two periods at 1 m/s^2
  double distance = 0.0;
  for (const DriveCommand& given : start.given) {
    distance += given.v * program.actuator().period;
  }
  CHECK(distance == doctest::Approx(0.5 * 0.2 * 0.2));
  CHECK(start.at(-1).v == doctest::Approx(0.2 - 0.5 * program.actuator().period));
}

TEST_CASE("limits without rates need no pieces") {
  const RolloutProgram program = program_of({.speed = {.dead_band = 0.2}});
  CHECK(program.pieces() == 1);
  CHECK(program.limited());
  const std::array past{DriveCommand{.v = 0.5}, DriveCommand{.v = 0.1}};
  const LimitedStart start = limited_start(program, past, {});
  CHECK(start.at(-1).v == 0.0);
  CHECK(start.at(-2).v == 0.5);
}

}  // namespace
}  // namespace slipwise
