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

MeasuredPose on_circle(double t, long frame = 0) {
  return {.t = t,
          .x = std::sin(kRate * t) / kRate,
          .y = (1.0 - std::cos(kRate * t)) / kRate,
          .yaw = std::remainder(kRate * t, 6.283185307179586),
          .frame = frame};
}

TEST_CASE("a window holds what was driven and what was commanded, past half turns too") {
  WindowCutter cutter;
  const InputBuffer commands = held(60.0);
  const InputBuffer none(0.5);
  for (int i = 0; i < 600; ++i) {
    cutter.push({.number = 3, .origin = 7.0}, on_circle(0.1 * i), commands, none);
  }
  REQUIRE(cutter.windows().size() >= 36);
  for (const MotionWindow& window : cutter.windows()) {
    CHECK(window.run == 3);
    CHECK(window.start == doctest::Approx(7.0 + window.since));
    CHECK(window.turn == doctest::Approx(kRate * window.duration));
    CHECK(window.distance == doctest::Approx(2.0 / kRate * std::sin(0.5 * kRate * window.duration)));
    CHECK(window.commands.forward == doctest::Approx(window.duration));
    CHECK(window.commands.rotation == doctest::Approx(window.turn));
    CHECK(window.wheels.known == 0.0);
  }
}

TEST_CASE("no window lies across two frames, or where inputs are unknown") {
  WindowCutter cutter;
  const InputBuffer commands = held(10.0);
  const InputBuffer none(0.5);
  for (int i = 0; i < 200; ++i) {
    MeasuredPose pose = on_circle(0.1 * i, i < 52 ? 0 : 1);
    pose.x += i < 52 ? 0.0 : 100.0;
    cutter.push({}, pose, commands, none);
  }
  CHECK(cutter.windows().size() == 6);  // three in each frame
  for (const MotionWindow& window : cutter.windows()) {
    CHECK(window.distance < 2.0);
    CHECK(window.start < 10.0);
  }
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
