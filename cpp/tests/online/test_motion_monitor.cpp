// SPDX-License-Identifier: Apache-2.0
// A blocked robot is seen within a second, and one that moves is never taken for one.
#include "slipwise/online/motion_monitor.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "streamed_robot.hpp"
#include "true_robot.hpp"

namespace slipwise {
namespace {

using tests::learner_settings;
using tests::push_within;
using tests::Span;
using tests::true_robot;
using tests::TrueDrive;
using tests::TrueRobot;

/// When the alarm came and went first [s], and how often it came.
struct Alarms {
  std::optional<double> came;
  std::optional<double> went;
  int count = 0;
};

Alarms alarms_of(const TrueDrive& drive, double begin = 0.0) {
  const TrueRobot robot = true_robot(drive);
  MotionLearner learner(learner_settings(!drive.wheels));
  learner.start_run();
  Alarms found;
  bool before = false;
  push_within(learner, robot.run, {begin, drive.seconds}, {}, [&](double t) {
    const MotionState state = learner.motion_monitor();
    CHECK(state.stuck == state.since.has_value());
    if (state.stuck && !before) {
      ++found.count;
      found.came = found.came.value_or(t);
    } else if (!state.stuck && before) {
      found.went = found.went.value_or(t);
    }
    before = state.stuck;
  });
  return found;
}

TEST_CASE("a robot that is blocked while its wheels go on is seen within a second, and so is its release") {
  for (const bool wheels : {false, true}) {
    double latest = 0.0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(wheels);
      CAPTURE(seed);
      const Alarms found = alarms_of({.seed = seed,
                                      .seconds = 60.0,
                                      .wheels = wheels,
                                      .pose_xy = 0.02,
                                      .pose_yaw = 0.01,
                                      .blocked = {40.3, 46.0}});
      REQUIRE(found.came);
      REQUIRE(found.went);
      CHECK(*found.came > 40.3);
      CHECK(*found.came < 41.3);
      CHECK(*found.went > 46.0);
      CHECK(*found.went < 47.0);
      CHECK(found.count == 1);
      latest = std::max(latest, *found.came - 40.3);
    }
    MESSAGE("seen after at most " << latest << " s");
  }
}

TEST_CASE("a robot that stays blocked stays known as stuck, whatever the learner makes of it") {
  const Alarms found = alarms_of({.seconds = 120.0, .pose_xy = 0.02, .pose_yaw = 0.01, .blocked = {40.3, 200.0}});
  CHECK(found.came);
  CHECK_FALSE(found.went);
}

TEST_CASE("a robot that moves raises no alarm, whatever the noise of its poses") {
  for (const bool wheels : {false, true}) {
    for (const double noise : {0.005, 0.02, 0.1}) {
      CAPTURE(wheels);
      CAPTURE(noise);
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        CHECK(alarms_of({.seed = seed, .wheels = wheels, .pose_xy = noise, .pose_yaw = noise / 2.0}).count == 0);
      }
    }
  }
}

TEST_CASE("where nothing was learned yet, nothing is said") {
  CHECK(alarms_of({.seconds = 46.0, .blocked = {42.3, 46.0}}, 36.0).count == 0);
}

TEST_CASE("a robot that slips far more than was learned achieves a fraction of the expected motion") {
  TrueRobot robot = true_robot({.seconds = 50.0, .pose_xy = 0.01, .pose_yaw = 0.005});
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  std::optional<double> before;
  std::optional<double> after;
  for (MeasuredPose& pose : robot.run.poses) {
    if (pose.t > 40.0) {  // half as far along the same path
      const Pose2 there = robot.at(40.0 + (pose.t - 40.0) / 2.0);
      pose = {.t = pose.t, .x = there.x, .y = there.y, .yaw = there.theta};
    }
  }
  push_within(learner, robot.run, {0.0, 41.0}, {}, [&](double t) {
    const MotionState state = learner.motion_monitor();
    (t < 39.9 ? before : after) = state.fraction;
  });
  REQUIRE(before);
  REQUIRE(after);
  CHECK(*before == doctest::Approx(1.0).epsilon(0.2));
  CHECK(*after == doctest::Approx(0.5).epsilon(0.3));
}

TEST_CASE("a robot that is not told to move, or whose inputs are unknown, is not stuck") {
  for (const bool stale : {false, true}) {
    const TrueRobot robot = true_robot({.seconds = 40.0, .pose_xy = 0.01, .pose_yaw = 0.005});
    MotionLearner learner(learner_settings(true));
    learner.start_run();
    push_within(learner, robot.run, {0.0, 40.0}, {}, [&](double) { learner.motion_monitor(); });
    for (int i = 0; i < 100; ++i) {
      const double t = 43.0 + 0.05 * i;
      if (!stale) {
        learner.push(CommandSample{{t, {0.0, 0.0, 0.0}}});
      }
      learner.push(MeasuredPose{.t = t + 0.001, .x = robot.pose.back().x, .y = robot.pose.back().y, .yaw = 0.0});
      CHECK_FALSE(learner.motion_monitor().stuck);
    }
    CHECK_FALSE(learner.motion_monitor().fraction);
  }
}

TEST_CASE("a robot that stops at once when it is told to, where it lagged before, is not stuck") {
  const TrueRobot robot = true_robot({.seconds = 40.0, .pose_xy = 0.005, .pose_yaw = 0.0025});
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  push_within(learner, robot.run, {0.0, 40.0}, {}, [&](double) { learner.motion_monitor(); });
  const MeasuredPose last = robot.run.poses.back();
  for (int i = 0; i < 60; ++i) {
    const double t = 40.01 + 0.05 * i;
    learner.push(CommandSample{{t, {0.0, 0.0, 0.0}}});
    learner.push(MeasuredPose{.t = t + 0.001, .x = last.x, .y = last.y, .yaw = last.yaw});
    CHECK_FALSE(learner.motion_monitor().stuck);
  }
}

/// How often the alarm comes for a robot that turns one way and the other, whose body and poses become late from 60 s
/// on.
int alarms_at_reversals(double lag, double late, std::uint64_t seed) {
  constexpr double kStep = 0.005;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto asked = [](double t) { return std::fmod(t, 8.0) < 4.0 ? 0.8 : -0.8; };
  std::vector<Pose2> path(1);
  double rate = 0.0;
  for (int i = 0; kStep * i < 100.0; ++i) {
    const double t = kStep * i;
    rate += (asked(t) - rate) * kStep / (t < 60.0 ? 0.1 : lag);
    path.push_back(compose(path.back(), exp(Eigen::Vector3d(0.0, 0.0, 0.8 * rate) * kStep)));
  }
  MotionLearner learner(learner_settings(false));
  learner.start_run();
  int alarms = 0;
  bool before = false;
  for (int i = 0; i < 1990; ++i) {
    const double t = 0.05 * i;
    learner.push(WheelSample{{t, {0.0, 0.0, asked(t)}}});
    if (i % 2 == 0) {
      const double seen = t - late * std::clamp((t - 61.0) / 2.0, 0.0, 1.0);
      const Pose2& pose = path[static_cast<std::size_t>(seen / kStep)];
      learner.push(MeasuredPose{.t = t + 0.01,
                                .x = pose.x + noise(generator),
                                .y = pose.y + noise(generator),
                                .yaw = pose.theta + 0.5 * noise(generator)});
      const bool stuck = learner.motion_monitor().stuck;
      alarms += stuck && !before ? 1 : 0;
      before = stuck;
    }
  }
  return alarms;
}

TEST_CASE("a robot that turns back later than it was learned to is not stuck") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    CAPTURE(seed);
    CHECK(alarms_at_reversals(0.5, 0.2, seed) == 0);
    CHECK(alarms_at_reversals(0.5, 0.3, seed) == 0);
    CHECK(alarms_at_reversals(0.7, 0.1, seed) == 0);
  }
}

TEST_CASE("asking whether the robot moves changes nothing of what is learned") {
  const TrueRobot robot = true_robot({.seconds = 40.0});
  MotionLearner silent(learner_settings(true));
  MotionLearner asked = silent;
  silent.start_run();
  asked.start_run();
  push_within(silent, robot.run, {0.0, 40.0}, {}, [](double) {});
  push_within(asked, robot.run, {0.0, 40.0}, {}, [&](double) { asked.motion_monitor(); });
  CHECK(silent.save() == asked.save());
}

}  // namespace
}  // namespace slipwise
