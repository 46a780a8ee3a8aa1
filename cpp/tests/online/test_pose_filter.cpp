// SPDX-License-Identifier: Apache-2.0
// Measured poses and learned motion together: as exact as it says, however late measurements are.
#include "slipwise/online/pose_filter.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "slipwise/linear/innovation.hpp"
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

Eigen::Vector3d error_of(const Pose2& estimated, const Pose2& truth) {
  Eigen::Vector3d error = estimated.vector() - truth.vector();
  error.z() = wrap_angle(error.z());
  return error;
}

/// Mean normalised squared error, and root mean squares of the errors of the filter and of the last pose.
struct Figures {
  double nees = 0.0;
  double position = 0.0;
  double heading = 0.0;
  double raw_position = 0.0;
};

Figures figures_of(const TrueDrive& like, std::uint64_t seeds) {
  Figures sum;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    TrueDrive drive = like;
    drive.seed = seed;
    const TrueRobot robot = true_robot(drive);
    MotionLearner learner(learner_settings(!drive.wheels));
    learner.start_run();
    double asked = 0.0;
    std::size_t pose = 0;
    push_within(learner, robot.run, {0.0, drive.seconds}, {}, [&](double t) {
      while (pose + 1 < robot.run.poses.size() && robot.run.poses[pose + 1].t <= t) {
        ++pose;
      }
      if (t < asked + 0.05) {
        return;
      }
      asked = t;
      const std::optional<Odometry> odometry = learner.odometry();
      if (t < 30.0 || !odometry) {
        return;
      }
      const Eigen::Vector3d error = error_of(odometry->pose, robot.at(odometry->t));
      const MeasuredPose& last = robot.run.poses[pose];
      const Eigen::Vector3d raw = error_of({last.x, last.y, last.yaw}, robot.at(last.t));
      sum.nees += normalised_square(error, odometry->covariance);
      sum.position += error.head<2>().squaredNorm();
      sum.heading += error.z() * error.z();
      sum.raw_position += raw.head<2>().squaredNorm();
      ++count;
    });
  }
  REQUIRE(count > 0);
  return {sum.nees / count, std::sqrt(sum.position / count), std::sqrt(sum.heading / count),
          std::sqrt(sum.raw_position / count)};
}

TEST_CASE("the filter is as exact as it says, and more exact than the poses, where their noise is white") {
  for (const bool wheels : {false, true}) {
    CAPTURE(wheels);
    const Figures found = figures_of({.seconds = 60.0, .wheels = wheels, .pose_xy = 0.05, .pose_yaw = 0.03}, 4);
    MESSAGE("white: NEES " << found.nees << ", position " << found.position << " m, heading " << found.heading
                           << " rad, raw poses " << found.raw_position << " m");
    CHECK(found.nees > 0.5);
    CHECK(found.nees < 4.5);
    CHECK(found.position < 0.6 * found.raw_position);
    CHECK(found.heading < 0.6 * 0.03);
  }
}

TEST_CASE("odometry is at its stamp however late poses are stamped, once wheel speeds tell it") {
  const Figures found =
      figures_of({.seconds = 60.0, .wheels = true, .pose_xy = 0.02, .pose_yaw = 0.01, .late = 0.2}, 4);
  MESSAGE("stamped 0.2 s late: NEES " << found.nees << ", position " << found.position << " m, heading "
                                      << found.heading << " rad, raw poses " << found.raw_position << " m");
  CHECK(found.raw_position > 0.1);
  CHECK(found.nees > 0.5);
  CHECK(found.nees < 4.5);
  CHECK(found.position < 0.03);
  CHECK(found.heading < 0.015);
}

TEST_CASE("the filter does not claim too much where errors of poses last, and is no worse than the poses") {
  for (const double correlation : {0.5, 5.0}) {
    CAPTURE(correlation);
    const Figures found =
        figures_of({.seconds = 60.0, .pose_xy = 0.02, .pose_yaw = 0.01, .correlation = correlation}, 4);
    MESSAGE("correlated: NEES " << found.nees << ", position " << found.position << " m, heading " << found.heading
                                << " rad, raw poses " << found.raw_position << " m");
    CHECK(found.nees < 4.5);
    CHECK(found.position < 1.1 * found.raw_position);
  }
}

/// Distance from the truth after 5 s without poses, and the normalised squared error.
struct Missed {
  double distance = 0.0;
  double nees = 0.0;
};

Missed missed_after_gap(bool wheels, std::uint64_t seed, bool learn) {
  const TrueRobot robot = true_robot({.seed = seed, .seconds = 80.0, .wheels = wheels, .gap = {60.0, 65.0}});
  MotionLearner learner(learner_settings(!wheels));
  learner.start_run();
  push_within(learner, robot.run, {learn ? 0.0 : 58.0, 65.0}, {}, [](double) {});
  const std::optional<Odometry> odometry = learner.odometry();
  REQUIRE(odometry);
  CHECK(odometry->since_pose == doctest::Approx(5.04).epsilon(0.01));
  const Eigen::Vector3d error = error_of(odometry->pose, robot.at(odometry->t));
  return {error.head<2>().norm(), normalised_square(error, odometry->covariance)};
}

TEST_CASE("over a gap of 5 s between poses, what was learned at least halves the error of what was not") {
  for (const bool wheels : {false, true}) {
    CAPTURE(wheels);
    double learned = 0.0;
    double baseline = 0.0;
    double nees = 0.0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const Missed missed = missed_after_gap(wheels, seed, true);
      learned += missed.distance / 6.0;
      nees += missed.nees / 6.0;
      baseline += missed_after_gap(wheels, seed, false).distance / 6.0;
    }
    MESSAGE("after 5 s: " << learned << " m, unlearned " << baseline << " m, NEES " << nees);
    CHECK(learned < 0.5 * baseline);
    CHECK(nees < 6.0);
  }
}

TEST_CASE("poses that the inputs do not explain are followed") {
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  int unused = 0;
  for (int i = 0; i < 200; ++i) {  // pushed at 1 m/s, with wheels that stand still
    const double t = 0.05 * i;
    learner.push(CommandSample{{t, {0.0, 0.0, 0.0}}});
    learner.push(MeasuredPose{.t = t + 0.001, .x = t < 2.0 ? 0.0 : t - 2.0, .y = 0.0, .yaw = 0.0});
    const Odometry odometry = learner.odometry().value();
    CHECK(std::abs(odometry.pose.x - (t < 2.0 ? 0.0 : t - 2.0)) < 0.35);
    unused += odometry.since_pose > 0.01 ? 1 : 0;
  }
  CHECK(unused < 40);
}

TEST_CASE("measurements that come late lead to the same pose as those that come in order") {
  for (const bool wheels : {false, true}) {
    for (const tests::Lateness late : {tests::Lateness{0.0, 0.3}, tests::Lateness{0.3, 0.0}}) {
      CAPTURE(wheels);
      CAPTURE(late.poses);
      const TrueRobot robot = true_robot({.seconds = 30.0, .wheels = wheels});
      std::vector<Odometry> last;
      for (const tests::Lateness& each : {tests::Lateness{}, late}) {
        MotionLearner learner(learner_settings(!wheels));
        learner.start_run();
        push_within(learner, robot.run, {0.0, 30.0}, each, [&](double) { learner.odometry(); });
        last.push_back(learner.odometry().value());
      }
      CHECK(last[0].t == last[1].t);
      CHECK((last[0].pose.vector() - last[1].pose.vector()).cwiseAbs().maxCoeff() < 1e-9);
      CHECK((last[0].covariance - last[1].covariance).cwiseAbs().maxCoeff() < 1e-9);
    }
  }
}

TEST_CASE("asking where the robot is changes nothing of what is learned") {
  for (const bool wheels : {false, true}) {
    const TrueRobot robot = true_robot({.seconds = 40.0, .wheels = wheels});
    MotionLearner silent(learner_settings(!wheels));
    MotionLearner asked = silent;
    silent.start_run();
    asked.start_run();
    push_within(silent, robot.run, {0.0, 40.0}, {}, [](double) {});
    push_within(asked, robot.run, {0.0, 40.0}, {}, [&](double) { asked.odometry(); });
    CHECK(silent.save() == asked.save());
  }
}

TEST_CASE("before anything is learned, poses and inputs alone give odometry; before any pose there is none") {
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  CHECK_FALSE(learner.odometry());
  learner.push(CommandSample{{1.0, {0.5, 0.0, 0.0}}});
  CHECK_FALSE(learner.odometry());
  learner.push(MeasuredPose{.t = 1.05, .x = 3.0, .y = -2.0, .yaw = 0.5, .frame = 7});
  const std::optional<Odometry> odometry = learner.odometry();
  REQUIRE(odometry);
  CHECK(odometry->pose.x == doctest::Approx(3.0));
  CHECK(odometry->pose.y == doctest::Approx(-2.0));
  CHECK(odometry->frame == 7);
  CHECK(odometry->covariance.ldlt().isPositive());
  CHECK(odometry->twist_covariance.allFinite());
}

/// A robot that stands at (x, y), seen every 50 ms.
void stand(MotionLearner& learner, double begin, double x, int poses, long frame = 0) {
  for (int i = 0; i < poses; ++i) {
    const double t = begin + 0.05 * i;
    learner.push(CommandSample{{t, {0.0, 0.0, 0.0}}});
    learner.push(MeasuredPose{.t = t + 0.001, .x = x, .y = 1.0, .yaw = 3.14, .frame = frame});
  }
}

TEST_CASE("a lone pose far away moves nothing; one that lasts is followed after a few") {
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  stand(learner, 0.0, 2.0, 40);
  stand(learner, 2.0, 9.0, 1);
  CHECK(learner.odometry()->pose.x == doctest::Approx(2.0).epsilon(0.01));
  stand(learner, 2.05, 2.0, 20);
  CHECK(learner.odometry()->pose.x == doctest::Approx(2.0).epsilon(0.01));
  stand(learner, 3.05, 9.0, 3);
  CHECK(learner.odometry()->pose.x == doctest::Approx(2.0).epsilon(0.01));
  stand(learner, 3.2, 9.0, 1);
  CHECK(learner.odometry()->pose.x == doctest::Approx(9.0).epsilon(0.01));
}

TEST_CASE("whatever standard deviations come with poses, odometry is finite") {
  for (const double std : {1e-300, 1e-9, 1e5}) {
    MotionLearner learner(learner_settings(true));
    learner.start_run();
    for (int i = 0; i < 60; ++i) {
      learner.push(CommandSample{{0.05 * i, {0.5, 0.0, 0.2}}});
      learner.push(MeasuredPose{.t = 0.05 * i + 0.001, .x = 0.02 * i, .y = 0.0, .yaw = 0.0, .std = {std, std}});
      const std::optional<Odometry> odometry = learner.odometry();
      REQUIRE(odometry);
      REQUIRE(odometry->pose.vector().allFinite());
      REQUIRE(odometry->covariance.allFinite());
      REQUIRE(odometry->covariance.diagonal().minCoeff() > 0.0);
    }
  }
}

TEST_CASE("a pose sensor off base_link, turned too, says where base_link is and how it moves") {
  const TrueRobot robot = true_robot({.seconds = 40.0, .pose_xy = 0.005, .pose_yaw = 0.003});
  const Pose2 sensor{0.4, -0.2, 0.5};
  Recording seen = robot.run;
  for (MeasuredPose& pose : seen.poses) {
    const Pose2 at = compose({pose.x, pose.y, pose.yaw}, sensor);
    pose = {.t = pose.t, .x = at.x, .y = at.y, .yaw = at.theta};
  }
  LearnerSettings settings = learner_settings(true);
  std::vector<Odometry> both;
  for (const bool off : {false, true}) {
    settings.stream.sensor = off ? sensor : Pose2{};
    MotionLearner learner(settings);
    learner.start_run();
    push_within(learner, off ? seen : robot.run, {0.0, 40.0}, {}, [](double) {});
    both.push_back(learner.odometry().value());
  }
  CHECK((both[0].pose.vector() - both[1].pose.vector()).head<2>().norm() < 0.02);
  CHECK(std::abs(wrap_angle(both[0].pose.theta - both[1].pose.theta)) < 0.01);
  CHECK(both[0].twist.v == doctest::Approx(both[1].twist.v).epsilon(0.03));
  CHECK(both[0].twist.omega == doctest::Approx(both[1].twist.omega).epsilon(0.05));
}

TEST_CASE("another frame, and another run, begin again") {
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  stand(learner, 0.0, 2.0, 40);
  stand(learner, 2.0, -50.0, 1, 1);
  CHECK(learner.odometry()->pose.x == doctest::Approx(-50.0));
  CHECK(learner.odometry()->frame == 1);
  learner.start_run();
  CHECK_FALSE(learner.odometry());
}

TEST_CASE("a heading at half a turn is not averaged with its opposite") {
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  for (int i = 0; i < 40; ++i) {
    learner.push(CommandSample{{0.05 * i, {0.0, 0.0, 0.0}}});
    learner.push(MeasuredPose{.t = 0.05 * i + 0.001, .x = 0.0, .y = 0.0, .yaw = i % 2 == 0 ? 3.14 : -3.14});
  }
  CHECK(std::abs(wrap_angle(learner.odometry()->pose.theta - 3.14159)) < 0.01);
}

TEST_CASE("without inputs the pose becomes unsure, and without anyone asking nothing piles up") {
  MotionLearner learner(learner_settings(true));
  learner.start_run();
  learner.push(CommandSample{{0.0, {0.5, 0.0, 0.0}}});
  for (int i = 0; i < 2000; ++i) {
    learner.push(MeasuredPose{.t = 0.05 * i, .x = 0.0, .y = 0.0, .yaw = 0.0});
  }
  learner.push(Tilt{105.0, 0.0, 0.0});
  const std::optional<Odometry> odometry = learner.odometry();
  REQUIRE(odometry);
  CHECK(odometry->since_pose == doctest::Approx(105.0 - 99.95));
  CHECK(std::sqrt(odometry->covariance(0, 0)) > 1.0);
}

}  // namespace
}  // namespace slipwise
