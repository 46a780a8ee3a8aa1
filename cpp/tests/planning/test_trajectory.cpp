// SPDX-License-Identifier: Apache-2.0
// Trajectories reach reachable goals within the limits, and say so when they cannot.
// So hold reach_goal and speed_profile.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "sample_manoeuvres.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/planning/trajectory.hpp"
#include "slipwise/segment/ground.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

constexpr DriveLimits kLimits{.speed = 1.5, .yaw_rate = 1.0, .curvature = 0.8, .acceleration = 0.8};

TrajectorySettings quick_settings(double end_speed) {
  return {.cruise = 1.2, .end_speed = end_speed, .longest = 8.0, .samples = 5000};
}

tests::SampleModel skidding(bool dynamics) { return tests::sample_model(named_basis("odd-even-10"), dynamics); }

Pose2 driven(const tests::SampleModel& sample, const Trajectory& plan, const ActuatorState& start,
             const std::shared_ptr<const Ground>& ground = {}) {
  std::vector<double> t{-100.0}, v{start.commanded.v}, omega{start.commanded.omega};
  t.insert(t.end(), plan.t.begin(), plan.t.end());
  v.insert(v.end(), plan.v.begin(), plan.v.end());
  omega.insert(omega.end(), plan.omega.begin(), plan.omega.end());
  const std::vector<double> vy(t.size(), 0.0);
  const Segment segment{.start = 0.0, .end = plan.path.t.back(), .initial = start.drive, .ground = ground};
  return integrate_segment(sample.motion, sample.parameters, InputHistory(t, v, vy, omega), segment).poses.back();
}

void check_limits(const Trajectory& plan, double start_speed) {
  double before = start_speed;
  for (std::size_t k = 0; k < plan.v.size(); ++k) {
    CHECK(std::abs(plan.v[k]) <= kLimits.speed + 1e-9);
    CHECK(std::abs(plan.omega[k]) <= kLimits.yaw_rate + 1e-9);
    CHECK(std::abs(plan.omega[k]) <= kLimits.curvature * std::abs(plan.v[k]) + 1e-9);
    const double period = plan.t[1] - plan.t[0];
    CHECK(std::abs(plan.v[k] - before) <= kLimits.acceleration * period + 1e-9);
    before = plan.v[k];
  }
}

void check_goals(const tests::SampleModel& sample, double end_speed, const ActuatorState& start) {
  CAPTURE(sample.name);
  const TrajectoryPlanner planner({sample.motion, sample.parameters}, kLimits, quick_settings(end_speed), start);
  const ReachProblem problem = planner.problem(start, planner.settings().cruise);
  std::mt19937_64 random(11);
  constexpr int kGoals = 200;
  int reached = 0;
  for (int i = 0; i < kGoals; ++i) {
    const ManoeuvreVector hidden = tests::random_manoeuvre(problem.bounds, random);
    const Pose2 goal = manoeuvre_pose(problem.model, problem.frame, hidden, start);
    const Trajectory plan = planner.to(goal, start);
    if (plan.status != TrajectoryStatus::Reached) {
      continue;
    }
    ++reached;
    const Pose2 end = driven(sample, plan, start);
    CHECK(std::hypot(end.x - goal.x, end.y - goal.y) < 1.1e-3);
    CHECK(std::abs(wrap_angle(end.theta - goal.theta)) < 1.1e-3);
    CHECK((plan.path.poses.back().vector() - end.vector()).norm() < 1e-9);
    check_limits(plan, start.commanded.v);
  }
  CHECK(reached >= kGoals - 2);
}

TEST_CASE("trajectories reach reachable goals within all limits, with and without lag, at rest and passing") {
  check_goals(skidding(false), 0.6, {});
  check_goals(skidding(true), 0.0, {});
  const BodyTwist moving{.v = 0.8, .vy = 0.0, .omega = 0.3};
  check_goals(skidding(true), 0.6, {.drive = moving, .commanded = moving});
}

TEST_CASE("a plan refuses an attitude that was measured for ground") {
  const tests::SampleModel sample = skidding(false);
  const TrajectoryPlanner planner({sample.motion, sample.parameters}, kLimits, quick_settings(0.0), {});
  const auto measured = std::make_shared<const Ground>(MeasuredTilts{{{0.0, 0.1, 0.0}}});
  CHECK_THROWS_AS(planner.to({2.0, 0.0, 0.0}, {}, measured), std::invalid_argument);
}

TEST_CASE("a trajectory goes on from where another one ended, though commands are still on their way then") {
  const tests::SampleModel sample = skidding(true);
  const TrajectoryPlanner planner({sample.motion, sample.parameters}, kLimits, quick_settings(0.6));
  const Trajectory first = planner.to({3.0, 0.6, 0.4}, {});
  REQUIRE(first.status == TrajectoryStatus::Reached);
  const ActuatorState between{.drive = first.path.drive,
                              .commanded = {.v = first.v.back(), .omega = first.omega.back()}};
  const Pose2 leg{2.5, -0.5, -0.3};
  const Trajectory second = planner.to(leg, between);
  REQUIRE(second.status == TrajectoryStatus::Reached);
  Trajectory both = first;
  const double join = first.path.t.back();
  for (std::size_t k = 0; k < second.t.size(); ++k) {
    both.t.push_back(join + second.t[k]);
    both.v.push_back(second.v[k]);
    both.omega.push_back(second.omega[k]);
  }
  both.path.t.push_back(join + second.path.t.back());
  const Pose2 expected = compose(first.path.poses.back(), second.path.poses.back());
  CHECK((driven(sample, both, {}).vector() - expected.vector()).norm() < 5e-3);
}

TEST_CASE("trajectories drive backwards where asked to") {
  TrajectorySettings settings = quick_settings(0.0);
  settings.backwards = true;
  const tests::SampleModel sample = skidding(true);
  const TrajectoryPlanner planner({sample.motion, sample.parameters}, kLimits, settings);
  const Trajectory plan = planner.to({-3.0, 0.5, -0.3}, {});
  REQUIRE(plan.status == TrajectoryStatus::Reached);
  CHECK(*std::ranges::max_element(plan.v) <= 0.0);
  CHECK(driven(sample, plan, {}).x == doctest::Approx(-3.0).epsilon(1e-3));
}

TEST_CASE("trajectories end straight where asked to") {
  TrajectorySettings settings = quick_settings(0.6);
  settings.straight_end = true;
  const tests::SampleModel sample = skidding(false);
  const TrajectoryPlanner planner({sample.motion, sample.parameters}, kLimits, settings);
  const Trajectory plan = planner.to({3.5, 1.0, 0.5}, {});
  REQUIRE(plan.status == TrajectoryStatus::Reached);
  CHECK(plan.omega.back() == 0.0);
  CHECK((driven(sample, plan, {}).vector() - Eigen::Vector3d(3.5, 1.0, 0.5)).norm() < 2e-3);
}

TEST_CASE("goals out of reach get a status with advice and the nearest attempt, never a made-up plan") {
  const tests::SampleModel sample = skidding(false);
  const TrajectoryPlanner planner({sample.motion, sample.parameters}, kLimits, quick_settings(0.0));
  const Trajectory beside = planner.to({0.0, 0.4, 0.0}, {});
  CHECK(beside.status == TrajectoryStatus::Unreachable);
  CHECK(beside.gap_xy + beside.gap_yaw > 1e-3);
  const Trajectory far = planner.to({40.0, 0.0, 0.0}, {});
  CHECK(far.status == TrajectoryStatus::TooFar);
  CHECK(advice(far.status).find("longer path") != std::string::npos);
}

TEST_CASE("a planner refuses what makes no sense") {
  const tests::SampleModel sample = skidding(false);
  const PlanningModel model(sample.motion, sample.parameters);
  TrajectorySettings fast = quick_settings(0.0);
  fast.cruise = 2.0;
  CHECK_THROWS_AS(TrajectoryPlanner(model, kLimits, fast), std::invalid_argument);
  DriveLimits stuck = kLimits;
  stuck.acceleration = 0.0;
  CHECK_THROWS_AS(TrajectoryPlanner(model, stuck, quick_settings(0.0)), std::invalid_argument);
  const TrajectoryPlanner planner(model, kLimits, quick_settings(0.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(planner.to({nan, 0.0, 0.0}, {}), std::invalid_argument);
  CHECK_THROWS_AS(planner.to({1.0, 0.0, 0.0}, {.drive = {.v = nan}}), std::invalid_argument);
  CHECK_THROWS_AS(planner.to({1.0, 0.0, 0.0}, {.commanded = {.v = 9.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
