// SPDX-License-Identifier: Apache-2.0
// What a stream knows of contradictions does not depend on how measurements interleave, and is saved.
#include "slipwise/online/motion_evidence.hpp"

#include <doctest/doctest.h>

#include <string>

#include "slipwise/archive/writer.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/probed_motion.hpp"
#include "slipwise/online/recording.hpp"
#include "streamed_robot.hpp"

namespace slipwise {
namespace {

using tests::learner_settings;
using tests::streamed_robot;

/// A robot that drives on an arc for some time, with hours at a standstill in the middle.
Recording parked_between(double before, double parked, double after) {
  Recording run;
  Pose2 pose;
  for (int i = 0; 0.1 * i < before + parked + after; ++i) {
    const double t = 0.1 * i;
    const bool stands = t >= before && t < before + parked;
    const BodyTwist twist = stands ? BodyTwist{} : BodyTwist{0.5, 0.0, 0.3};
    run.wheels.push_back({t, twist});
    run.poses.push_back({.t = t, .x = pose.x, .y = pose.y, .yaw = pose.theta});
    pose = compose(pose, exp(Eigen::Vector3d(twist.v, twist.vy, twist.omega) * 0.1));
  }
  return run;
}

std::string bytes_of(const MotionEvidence& evidence) {
  archive::Writer writer;
  writer(evidence);
  return std::string(writer.bytes());
}

TEST_CASE("evidence is the same of a recording and of measurements that arrive late") {
  const Recording run = streamed_robot(2, 30.0);
  const LearnerSettings settings = learner_settings(true);
  const std::string recorded = bytes_of(motion_evidence(settings.stream, std::vector{run}));
  for (const std::uint64_t seed : {1, 2, 3}) {
    MotionLearner learner(settings);
    learner.start_run();
    tests::push_late(learner, run, 0.45, seed);
    CHECK(bytes_of(learner.model().evidence) == recorded);
  }
}

TEST_CASE("pairs of poses are spread over all that was driven, with the wheels' path about them") {
  Recording run;
  Pose2 pose;
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.05 * i;
    run.wheels.push_back({t, {0.5, 0.0, 0.3}});
    run.poses.push_back({.t = t, .x = pose.x, .y = pose.y, .yaw = pose.theta});
    pose = compose(pose, exp(Eigen::Vector3d(0.5, 0.0, 0.3) * 0.05));
  }
  StreamSettings settings;
  settings.from_commands = false;
  const MotionEvidence evidence = motion_evidence(settings, std::vector{run});
  const auto& probes = evidence.probes();
  REQUIRE(probes.size() >= 128);
  CHECK(probes.size() < 256);
  CHECK(probes.front().first.t < 15.0);
  CHECK(probes.back().first.t > 285.0);
  for (const ProbedMotion& motion : probed_motions(probes, 0.0)) {
    CHECK((motion.measured.vector() - motion.rolled.vector()).norm() < 1e-4);
  }
  for (const ProbedMotion& motion : probed_motions(probes, 0.25)) {
    CHECK((motion.measured.vector() - motion.rolled.vector()).norm() < 1e-3);
  }
}

TEST_CASE("evidence of the last two minutes of driving counts no time at a standstill") {
  StreamSettings settings;
  settings.from_commands = false;
  CHECK_FALSE(motion_evidence(settings, std::vector{parked_between(60.0, 300.0, 40.0)}).recent());
  const auto recent = motion_evidence(settings, std::vector{parked_between(300.0, 300.0, 40.0)}).recent();
  REQUIRE(recent);
  double seconds = 0.0;
  for (const MotionWindow& window : recent->windows) {
    seconds += window.duration;
    CHECK(window.distance > 0.3);
  }
  CHECK(seconds >= 120.0);
  CHECK(seconds < 122.0);
  CHECK(recent->windows.front().start == doctest::Approx(300.0 - 80.0).epsilon(0.02));
  CHECK(recent->measured_windows.size() == recent->windows.size());
  CHECK(recent->counts.accepted >= 1180);
  CHECK(recent->counts.accepted <= 1220);
  CHECK(recent->probes.size() == 60);
}

TEST_CASE("turns of a gyro are summed against those of the inputs, run by run") {
  StreamSettings settings;
  settings.heading_only = true;
  std::vector<Recording> runs(2);
  for (std::size_t k = 0; k < 2; ++k) {
    for (int i = 0; i < 600; ++i) {
      runs[k].commands.push_back({0.05 * i, {0.5, 0.0, 0.4}});
      runs[k].readings[0].push_back({.t = 0.05 * i + 0.01, .value = k == 0 ? 0.3 : -0.3});
    }
  }
  const MotionEvidence evidence = motion_evidence(settings, runs);
  REQUIRE(evidence.gyro_turns().size() == 2);
  for (const GyroTurns& turns : evidence.gyro_turns()) {
    CHECK(turns.count >= 28);
    CHECK(turns.product / turns.square == doctest::Approx(turns.run == 0 ? 0.75 : -0.75));
  }
  CHECK(evidence.windows().empty());
  CHECK_FALSE(evidence.recent());
}

}  // namespace
}  // namespace slipwise
