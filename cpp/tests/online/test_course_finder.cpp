// SPDX-License-Identifier: Apache-2.0
// Positions get headings where the robot came along a way, and none where it did not.
#include "slipwise/online/course_finder.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

/// A robot that follows its inputs, and an antenna on it.
struct Robot {
  Pose2 antenna = {};
  InputBuffer inputs{0.5};
  CourseFinder finder{antenna};
  Pose2 pose = {};
  double t = 0.0;
  std::optional<double> found = {};

  /// Drives at a body twist for some seconds, at 10 Hz; `moves` says which part of it the robot really does.
  void drive(double v, double omega, double seconds, double moves = 1.0) {
    const int steps = static_cast<int>(std::lround(10.0 * seconds));
    for (int i = 0; i < steps; ++i) {
      inputs.push({t, {v, 0.0, omega}});
      pose = compose(pose, exp(Eigen::Vector3d(v, 0.0, omega) * 0.1 * moves));
      t += 0.1;
      const Pose2 at = compose(pose, antenna);
      found = finder.push({.t = t, .x = at.x, .y = at.y, .yaw = 0.0, .position = true}, inputs);
    }
  }
  double error() const { return wrap_angle(*found - pose.theta); }
};

}  // namespace

TEST_CASE("a robot that follows its inputs gets its own heading, forward, backward and on arcs") {
  for (const Pose2& antenna : {Pose2{}, Pose2{0.4, -0.2, 0.0}}) {
    Robot robot{.antenna = antenna};
    robot.drive(1.0, 0.0, 2.0);
    REQUIRE(robot.found);
    CHECK(robot.error() == doctest::Approx(0.0).epsilon(1e-9));
    robot.drive(1.0, 0.8, 2.0);
    CHECK(robot.error() == doctest::Approx(0.0).epsilon(1e-9));
    robot.drive(-1.0, 0.3, 4.0);
    CHECK(robot.error() == doctest::Approx(0.0).epsilon(1e-9));
  }
}

TEST_CASE("where the robot stands, spins its wheels or is moved, there is no heading") {
  Robot robot;
  robot.drive(0.0, 0.0, 3.0);
  CHECK_FALSE(robot.found);
  robot.drive(1.0, 0.0, 3.0);
  CHECK(robot.found);
  robot.drive(0.0, 0.0, 6.0);  // a way is forgotten after a while
  CHECK_FALSE(robot.found);
  robot.drive(1.0, 0.0, 4.0, 0.05);
  CHECK_FALSE(robot.found);
  InputBuffer parked(0.5);
  CourseFinder finder;
  std::optional<double> towed;
  for (int i = 0; i < 60; ++i) {
    parked.push({0.1 * i, {}});
    towed = finder.push({.t = 0.1 * i, .x = 0.1 * i, .y = 0.0, .yaw = 0.0, .position = true}, parked);
  }
  CHECK_FALSE(towed);
}

TEST_CASE("a robot that turned on the spot heads where its inputs turned it, and unwraps over whole turns") {
  Robot robot;
  robot.drive(1.0, 0.0, 2.0);
  robot.drive(0.0, 1.0, 2.0);
  REQUIRE(robot.found);
  CHECK(robot.error() == doctest::Approx(0.0).epsilon(1e-9));
  robot.drive(0.6, 0.9, 20.0);
  REQUIRE(robot.found);
  CHECK(*robot.found == doctest::Approx(robot.pose.theta).epsilon(1e-6));
  CHECK(*robot.found > 2.0 * std::numbers::pi);
}

TEST_CASE("a robot that turns where its inputs go straight heads as it turned, but for the last half metre") {
  InputBuffer inputs(0.5);
  CourseFinder finder;
  Pose2 pose;
  std::optional<double> before;
  std::optional<double> found;
  for (int i = 0; i < 60; ++i) {
    inputs.push({0.1 * i, {2.0, 0.0, 0.0}});
    before = found;
    found = finder.push({.t = 0.1 * i, .x = pose.x, .y = pose.y, .yaw = 0.0, .position = true}, inputs);
    pose = compose(pose, exp(Eigen::Vector3d(2.0, 0.0, 1.0) * 0.1));
  }
  REQUIRE(before);
  CHECK(*found - *before == doctest::Approx(0.1).epsilon(1e-6));
  CHECK(*found == doctest::Approx(5.9).epsilon(0.03));
}

TEST_CASE("no way leads from one frame to another, or over inputs that are unknown") {
  Robot robot;
  robot.drive(1.0, 0.0, 2.0);
  const MeasuredPose jumped{.t = robot.t + 0.1, .x = 50.0, .y = 0.0, .yaw = 0.0, .frame = 1, .position = true};
  CHECK_FALSE(robot.finder.push(jumped, robot.inputs));
  CourseFinder finder;
  finder.push({.t = 0.0, .x = 0.0, .y = 0.0, .yaw = 0.0, .position = true}, robot.inputs);
  CHECK_FALSE(finder.push({.t = 4.5, .x = 4.5, .y = 0.0, .yaw = 0.0, .position = true}, robot.inputs));
}

}  // namespace slipwise
