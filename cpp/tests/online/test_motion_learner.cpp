// SPDX-License-Identifier: Apache-2.0
// One measurement at a time: what is learned does not depend on how streams interleave.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "slipwise/online/motion_learner.hpp"
#include "streamed_robot.hpp"

namespace slipwise {
namespace {

using tests::learner_settings;
using tests::push_late;
using tests::streamed_robot;

constexpr double kSeconds = 45.0;

/// Of what is learned, the variance of the slip.
double slip_variance(const MotionPosterior& learned) {
  const Eigen::Index size = learned.model.slip_size();
  return learned.estimate.covariance.topLeftCorner(size, size).trace();
}

LearnedModel learned(const Recording& run, bool from_commands) {
  MotionLearner learner(learner_settings(from_commands));
  learner.start_run();
  push(learner, run);
  return learner.model();
}

void check_same(const LearnedModel& one, const LearnedModel& other) {
  CHECK(one.segments == other.segments);
  CHECK(one.weights == other.weights);
  CHECK(one.range.inputs() == other.range.inputs());
  CHECK(one.known.motion->estimate.mean == other.known.motion->estimate.mean);
  CHECK(one.known.motion->estimate.covariance == other.known.motion->estimate.covariance);
  REQUIRE(one.held_out.size() == other.held_out.size());
  for (std::size_t h = 0; h < one.held_out.size(); ++h) {
    REQUIRE(one.held_out[h].size() == other.held_out[h].size());
    for (std::size_t i = 0; i < one.held_out[h].size(); ++i) {
      CHECK(one.held_out[h][i].pose == other.held_out[h][i].pose);
      CHECK(one.held_out[h][i].covariance == other.held_out[h][i].covariance);
    }
  }
}

TEST_CASE("what is learned does not depend on how streams interleave within the latency") {
  for (const bool from_commands : {false, true}) {
    CAPTURE(from_commands);
    const Recording run = streamed_robot(1, kSeconds);
    const LearnedModel expected = learned(run, from_commands);
    CHECK(expected.segments > 10);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(seed);
      MotionLearner learner(learner_settings(from_commands));
      learner.start_run();
      push_late(learner, run, 0.45, seed);
      check_same(expected, learner.model());
    }
  }
}

TEST_CASE("a segment is learned before it is due, though measurements come rarely") {
  LearnerSettings settings = learner_settings(false);
  for (const char* name : {"drive-5", "odd-even-10", "thesis-15"}) {
    settings.hypotheses.bases.push_back(named_basis(name));
  }
  MotionLearner learner(settings);
  const Recording run = streamed_robot(3, 60.0);
  std::vector<double> learned_at;
  for (std::size_t i = 0; i < run.wheels.size(); i += 4) {
    learner.push(WheelSample{run.wheels[i]});
    if (i % 20 == 0) {
      learner.push(run.poses[i / 2]);
    }
    learned_at.resize(learner.learned().hypotheses().count(), run.wheels[i].t);
  }
  std::size_t segment = 0;
  for (const LearnerEvent& event : learner.events()) {
    if (event.kind == LearnerEvent::Kind::SegmentLearned && segment < learned_at.size()) {
      CHECK(learned_at[segment++] < event.t + 0.9);  // at 1 s all that waits is learned at once
    }
  }
  CHECK(segment > 40);
}

TEST_CASE("what is later than the latency is rejected and counted") {
  MotionLearner learner(learner_settings(false));
  learner.start_run();
  learner.push(MeasuredPose{.t = 10.0, .x = 0.0, .y = 0.0, .yaw = 0.0});
  learner.push(WheelSample{{9.4, {1.0, 0.0, 0.0}}});
  learner.push(WheelSample{{9.6, {1.0, 0.0, 0.0}}});
  const auto events = learner.events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].kind == LearnerEvent::Kind::Rejected);
  CHECK(events[0].stream == Stream::Wheels);
  CHECK(events[0].reason == Reason::TooLate);
  CHECK(events[0].t == 9.4);
}

TEST_CASE("runs are not joined, and what was learned stays") {
  const Recording first = streamed_robot(5, kSeconds);
  const Recording second = streamed_robot(6, 20.0, 10.0);  // by a clock that was set again
  MotionLearner learner(learner_settings(false));
  learner.start_run();
  push(learner, first);
  const LearnedModel before = learner.model();
  learner.start_run();
  push(learner, second);
  const LearnedModel after = learner.model();
  CHECK(after.segments > before.segments);
  CHECK(after.held_out[0].back().run == 1);
  for (const auto& predictions : after.held_out) {
    for (std::size_t i = 0; i < predictions.size(); ++i) {
      CHECK(predictions[i].end - predictions[i].start < 6.0);
    }
  }
}

TEST_CASE("a robot whose turns slip is learned from positions alone, and where one is a pose it joins nothing") {
  for (const bool from_commands : {false, true}) {
    CAPTURE(from_commands);
    Recording run = streamed_robot(5, 240.0);
    for (MeasuredPose& pose : run.poses) {
      pose.position = true;
      pose.yaw = std::numeric_limits<double>::quiet_NaN();
    }
    LearnerSettings settings = learner_settings(from_commands);
    settings.hypotheses.bases = {named_basis("full-linear-6")};
    settings.hypotheses.filter.prior.straight_side_slip_std = 0.03;
    MotionLearner learner(settings);
    push(learner, run);
    learner.end_run();
    const auto model = learner.model();
    CHECK(model.segments > 60);
    const Estimate& learned = model.known.motion->estimate;
    const double std = std::sqrt(learned.covariance(5, 5));
    CHECK(std < 0.03);
    CHECK(std::abs(learned.mean[5] + 1.0 / 3.0) < 3.0 * std);

    MotionLearner saved = MotionLearner::load(learner.save());
    CHECK(saved.save() == learner.save());

    MotionLearner mixed(settings);
    for (std::size_t i = 0; i < run.poses.size(); i += 2) {
      run.poses[i].position = false;
      run.poses[i].yaw = 0.0;
    }
    push(mixed, run);
    mixed.end_run();
    CHECK(mixed.model().segments == 0);
  }
}

TEST_CASE("poses that are said to be poor spoil less, and poses said to be alike are poses without a word") {
  Recording run = streamed_robot(4, 2.0 * kSeconds);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < run.poses.size(); ++i) {
    const bool poor = (i / 100) % 3 == 2;  // ten seconds of thirty
    run.poses[i].yaw += (poor ? 0.05 : 0.0) * normal(random);
    run.poses[i].std = {.xy = 0.005, .yaw = poor ? 0.05 : 0.003};
  }
  Recording silent = run;
  std::ranges::for_each(silent.poses, [](MeasuredPose& pose) { pose.std = {}; });
  Recording alike = run;
  std::ranges::for_each(alike.poses, [](MeasuredPose& pose) { pose.std = {.xy = 3.0, .yaw = 1e6}; });
  check_same(learned(silent, false), learned(alike, false));
  const auto uncertainty = [](const Recording& recording) {
    return slip_variance(*learned(recording, false).known.slip);
  };
  CHECK(uncertainty(run) < uncertainty(silent));
  Recording impossible = silent;
  impossible.poses[50].std.yaw = -1.0;
  const RejectionCounts rejected = learned(impossible, false).rejected;
  CHECK(rejected[static_cast<std::size_t>(Stream::Pose)][static_cast<std::size_t>(Reason::NotFinite)] == 1);
}

TEST_CASE("forgetting makes slip less sure at once, and a fraction beyond 0 to 1 is refused") {
  MotionLearner learner(learner_settings(false));
  learner.start_run();
  push(learner, streamed_robot(8, kSeconds));
  const auto spread = [&] { return slip_variance(*learner.model().known.slip); };
  const double before = spread();
  learner.forget(0.5);
  CHECK(spread() > 2.0 * before);
  CHECK_THROWS_AS(learner.forget(1.5), std::invalid_argument);
}

TEST_CASE("what is asked wrongly is refused") {
  MotionLearner learner(learner_settings(true));
  CHECK_THROWS_AS(learner.predict({}, 1.0), std::invalid_argument);  // nothing was measured
  learner.start_run();
  push(learner, streamed_robot(9, 10.0));
  CHECK_THROWS_AS(learner.predict({}, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(learner.predict({}, 1e9), std::invalid_argument);
  CHECK_THROWS_AS(learner.predict({{5.0, {}}, {4.0, {}}}, 1.0), std::invalid_argument);
  CHECK_NOTHROW(learner.predict({}, 1.0));
}

}  // namespace
}  // namespace slipwise
