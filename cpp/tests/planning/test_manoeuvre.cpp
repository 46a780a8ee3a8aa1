// SPDX-License-Identifier: Apache-2.0
// The held commands of a manoeuvre: they cover its length, bend as its curvature says, and know their derivatives.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "finite_difference.hpp"
#include "slipwise/planning/manoeuvre.hpp"

namespace slipwise {
namespace {

const ManoeuvreFrame kFrame{
    .speeds = {.start = 0.2, .cruise = 1.0, .end = 0.4}, .acceleration = 0.5, .direction = 1.0, .commands = 16};

ManoeuvreVector bent() {
  ManoeuvreVector parameters;
  parameters << 0.1, 0.4, -0.3, 0.6, 0.2, -0.5, 0.3, 3.0;
  return parameters;
}

TEST_CASE("commands without limits stay as they are; a top holds them and their derivatives") {
  const HeldCommands held = held_commands(kFrame, bent());
  CHECK(limited_commands(held, {}, {}).commands.size() == held.commands.size());
  const HeldCommands cut = limited_commands(held, {.speed = {.saturation = 0.6}}, {.v = 0.2});
  CHECK(cut.period.value == held.period.value);
  int held_down = 0;
  for (std::size_t k = 0; k < held.end; ++k) {
    const bool over = held.commands[k].v > 0.6;
    held_down += over ? 1 : 0;
    CHECK(cut.commands[k].v == (over ? 0.6 : held.commands[k].v));
    CHECK(cut.commands[k].v_by_length == (over ? 0.0 : held.commands[k].v_by_length));
  }
  CHECK(held_down > 3);
}

TEST_CASE("a manoeuvre behind ramps is cut in pieces and settles for as long as the last ramp takes") {
  ManoeuvreFrame stop = kFrame;
  stop.speeds = {.start = 0.0, .cruise = 1.0, .end = 0.0};
  stop.settling = 0.25;
  const CommandLimits limits{.speed = {.slew_rate_up = 5.0, .slew_rate_down = 0.25}};
  const HeldCommands held = held_commands(stop, bent());
  const HeldCommands ramped = limited_commands(held, limits, {});
  const auto pieces = static_cast<double>(ramped.end) / static_cast<double>(held.end);
  CHECK(pieces > 1.0);
  CHECK(ramped.period.value * pieces == doctest::Approx(held.period.value));
  CHECK(ramped.settling > 0.25 + 1.0);  // it brakes half as hard as it is commanded to
  CHECK(ramped.commands.back().v == doctest::Approx(0.0));
  double before = 0.0;
  for (const HeldCommand& command : ramped.commands) {
    CHECK(before - command.v <= 0.25 * ramped.period.value + 1e-12);
    before = command.v;
  }
}

}  // namespace
}  // namespace slipwise
