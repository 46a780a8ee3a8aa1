// SPDX-License-Identifier: Apache-2.0
// Windows of about 1.5 s inside one frame, with the integrals of the inputs.
#include "slipwise/online/motion_window.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace slipwise {
namespace {

constexpr double kRate = 0.2;  // [rad/s] of a circle that is driven at 1 m/s

InputBuffer held(double until, double v = 1.0) {
  InputBuffer inputs(0.5);
  for (double t = 0.0; t < until; t += 0.1) {
    inputs.push({t, {v, 0.0, kRate}});
  }
  return inputs;
}

TEST_CASE("a position heads along its path, turned about where the robot drives backward") {
  for (const double v : {1.0, -1.0}) {
    WindowCutter cutter;
    const InputBuffer commands = held(10.0, v);
    const InputBuffer none(0.5);
    for (int i = 0; i < 90; ++i) {
      cutter.push({}, {.t = 0.1 * i, .x = 0.1 * v * i, .y = 0.0, .yaw = 0.0, .position = true}, commands, none);
    }
    REQUIRE(cutter.windows().size() == 5);
    CHECK(cutter.windows().back().start_yaw == doctest::Approx(0.0));
  }
}

TEST_CASE("memory does not grow with time") {
  WindowCutter cutter;
  const InputBuffer none(0.5);
  InputBuffer commands(1e9);
  commands.push({0.0, {1.0, 0.0, 0.0}});
  for (int i = 0; i < 10000; ++i) {
    cutter.push({}, {.t = 1.5 * i, .x = 1.5 * i, .y = 0.0, .yaw = 0.0}, commands, none);
  }
  CHECK(cutter.windows().size() == 4000);
}

}  // namespace
}  // namespace slipwise
