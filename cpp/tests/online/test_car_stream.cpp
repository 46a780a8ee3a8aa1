// SPDX-License-Identifier: Apache-2.0
// Throttle and steering in a stream of segments: causal, and the same however measurements interleave.
#include "slipwise/online/car_stream.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "slipwise/lie/se2.hpp"
#include "slipwise/online/recording.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {
namespace {

CarCurves true_car() {
  return {.speed = {.at = {-1.0, 0.0, 0.2, 1.0}, .value = {-1.0, 0.0, 0.0, 3.0}, .std = {}},
          .curvature = {.at = {-1.0, 1.0}, .value = {-1.5, 1.5}, .std = {}},
          .lag = 0.4,
          .steering_lag = 0.0,
          .cornering_drag = 0.1,
          .understeer = 0.05};
}

/// A car that weaves at changing throttle; poses ten times a second.
Recording drive(double seconds) {
  Recording run;
  CarState state;
  Pose2 at;
  const CarCurves car = true_car();
  for (int i = 0; i * 0.05 < seconds; ++i) {
    const double t = i * 0.05;
    const BodyTwist told{.v = 0.5 + 0.3 * std::sin(0.3 * t), .vy = 0.0, .omega = std::sin(0.7 * t)};
    run.commands.push_back({t, told});
    if (i % 2 == 0) {
      run.poses.push_back({.t = t, .x = at.x, .y = at.y, .yaw = at.theta});
    }
    for (int k = 0; k < 5; ++k) {
      state = advanced(car, state, told, 0.01);
      const BodyTwist twist = car_twist(car, state);
      at = compose(at, exp({0.01 * twist.v, 0.0, 0.01 * twist.omega}));
    }
  }
  return run;
}

StreamSettings car_settings() {
  StreamSettings settings;
  settings.car = CarPrior{.top_speed = 4.0, .curvature = 2.0};
  return settings;
}

TEST_CASE("segments of a car get twists that its curves make, and the curves are found") {
  SegmentStream stream(car_settings());
  const Recording run = drive(60.0);
  std::size_t pose = 0;
  for (const InputSample& command : run.commands) {
    stream.push(CommandSample{command});
    for (; pose < run.poses.size() && run.poses[pose].t <= command.t; ++pose) {
      stream.push(run.poses[pose]);
    }
  }
  stream.end_run();
  REQUIRE(stream.drive().car_curves());
  CHECK(stream.drive().car_curves()->speed(0.6) == doctest::Approx(true_car().speed(0.6)).epsilon(0.08));
  CHECK(stream.drive().car_curves()->curvature(0.6) == doctest::Approx(0.9).epsilon(0.08));
  const auto throttle = std::ranges::max(run.commands, {}, [](const InputSample& each) { return each.twist.v; });
  CHECK(stream.range().inputs()[1] == throttle.twist.v);
  int targets = 0;
  for (const StreamItem& item : stream.take_items()) {
    if (const auto* target = std::get_if<TargetSegment>(&item)) {
      ++targets;
      CHECK(target->baseline.has_value());
    }
  }
  CHECK(targets > 50);
}

TEST_CASE("a segment's twists do not depend on what was measured after what may be known of it") {
  const Recording run = drive(40.0);
  Recording other = run;
  for (MeasuredPose& pose : other.poses) {
    if (pose.t > 30.0) {
      pose.x += 0.5 * (pose.t - 30.0);
    }
  }
  const CutRuns one = cut_segments(car_settings(), std::vector{run});
  const CutRuns two = cut_segments(car_settings(), std::vector{other});
  int compared = 0;
  for (std::size_t i = 0; i < one.segments.size() && one.segments[i].segment.end <= 30.0; ++i) {
    const InputHistory& a = one.segments[i].inputs;
    const InputHistory& b = two.segments[i].inputs;
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      CHECK(a.sample(k) == b.sample(k));
    }
    ++compared;
  }
  CHECK(compared > 8);
}

/// How far the twists of a segment end from where it was measured to end [m and rad].
double missed(const DrivenSegment& driven) {
  const InputHistory& inputs = driven.inputs;
  Pose2 at;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const double from = std::max(inputs.time(k), driven.segment.start);
    const double to = k + 1 < inputs.size() ? std::min(inputs.time(k + 1), driven.segment.end) : driven.segment.end;
    if (to > from) {
      const BodyTwist twist = inputs.sample(k);
      at = compose(at, exp((to - from) * Eigen::Vector3d(twist.v, twist.vy, twist.omega)));
    }
  }
  return (at.vector() - rows_of(driven.segment.measured)).norm();
}

TEST_CASE("what a car does at a start is known by all poses up to there, between the twists that are learned too") {
  Recording run = drive(10.2);
  run.poses.resize(102);  // of every tenth of a second, the last at 10.1 s; twists that are learned end at 10 s
  const auto speed = [&] {
    CarStream stream({.top_speed = 4.0, .curvature = 2.0}, {}, 0.5);
    for (const InputSample& command : run.commands) {
      stream.push_command(command, 0.5);
    }
    for (const MeasuredPose& pose : run.poses) {
      stream.push_pose(pose);
    }
    return stream.inputs(10.1, 10.2, 10.1).at(10.11).v;
  };
  const double before = speed();
  MeasuredPose& last = run.poses.back();
  REQUIRE(last.t == doctest::Approx(10.1));
  last.x += 0.05 * std::cos(last.yaw);
  last.y += 0.05 * std::sin(last.yaw);
  CHECK(speed() > before + 0.05);
}

TEST_CASE("held curves drive the segments that are cut without them, and need not be learned first") {
  const std::vector runs{drive(40.0)};
  StreamSettings settings = car_settings();
  const CutRuns learned = cut_segments(settings, runs);
  settings.car->held = true_car();
  const CutRuns held = cut_segments(settings, runs);
  REQUIRE(held.segments.size() == learned.segments.size());
  REQUIRE(held.segments.size() > 10);
  double of_held = 0.0, of_learned = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(held.segments[i].segment.start == learned.segments[i].segment.start);
    of_held += missed(held.segments[i]);
    of_learned += missed(learned.segments[i]);
  }
  CHECK(of_held < 0.2 * of_learned);
  CHECK(missed(held.segments.front()) < 0.05);
}

TEST_CASE("poses that come late by less than the latency change nothing") {
  const Recording run = drive(30.0);
  SegmentStream together(car_settings()), late(car_settings());
  std::size_t first = 0, second = 0;
  for (const InputSample& command : run.commands) {
    together.push(CommandSample{command});
    late.push(CommandSample{command});
    for (; first < run.poses.size() && run.poses[first].t <= command.t; ++first) {
      together.push(run.poses[first]);
    }
    for (; second < run.poses.size() && run.poses[second].t <= command.t - 0.4; ++second) {
      late.push(run.poses[second]);
    }
  }
  for (; second < first; ++second) {
    late.push(run.poses[second]);
  }
  together.end_run();
  late.end_run();
  const auto one = together.take_items(), two = late.take_items();
  REQUIRE(one.size() == two.size());
  CHECK(together.drive().car_curves()->speed.value == late.drive().car_curves()->speed.value);
  for (std::size_t i = 0; i < one.size(); ++i) {
    const auto* a = std::get_if<DrivenSegment>(&one[i]);
    const auto* b = std::get_if<DrivenSegment>(&two[i]);
    REQUIRE((a == nullptr) == (b == nullptr));
    if (a != nullptr) {
      REQUIRE(a->inputs.size() == b->inputs.size());
      for (std::size_t k = 0; k < a->inputs.size(); ++k) {
        CHECK(a->inputs.sample(k) == b->inputs.sample(k));
      }
    }
  }
}

TEST_CASE("a new run begins with the curves that are known and a car that stands") {
  CarStream stream({.top_speed = 4.0, .curvature = 2.0}, {}, 0.5);
  const Recording run = drive(20.0);
  std::size_t pose = 0;
  for (const InputSample& command : run.commands) {
    stream.push_command(command, 0.5);
    for (; pose < run.poses.size() && run.poses[pose].t <= command.t; ++pose) {
      stream.push_pose(run.poses[pose]);
    }
  }
  const auto known = stream.curves().speed.value;
  stream.start_run();
  CHECK(stream.curves().speed.value == known);
  CHECK(stream.given().empty());
  CHECK(stream.inputs(0.0, 1.0, 0.0).at(0.5).v == 0.0);
}

}  // namespace
}  // namespace slipwise
