// SPDX-License-Identifier: Apache-2.0
// Shaping a manoeuvre: it ends at the goal within its bounds, from a guess outside them too, or says that it does not.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "sample_manoeuvres.hpp"
#include "slipwise/planning/reach_goal.hpp"

namespace slipwise {
namespace {

struct Sample {
  tests::SampleModel robot = tests::sample_model(named_basis("odd-even-10"), true);
  PlanningModel model{robot.motion, robot.parameters};
  ReachProblem problem{.model = model,
                       .frame = {.speeds = {.start = 0.0, .cruise = 1.0, .end = 0.0}, .settling = 2.0},
                       .start = {},
                       .bounds = tests::sample_bounds(6.0)};
  ManoeuvreVector straight(double length) const {
    ManoeuvreVector guess = ManoeuvreVector::Zero();
    guess[kLength] = length;
    return guess;
  }
};

TEST_CASE("a goal near the guess is reached, and the pose is where the parameters lead") {
  const Sample sample;
  const Pose2 goal{.x = 3.0, .y = 0.6, .theta = 0.4};
  const Reach reach = reach_goal(sample.problem, goal, sample.straight(3.0));
  CHECK(reach.reached);
  CHECK(reach.gap_xy <= 1e-3);
  CHECK(reach.gap_yaw <= 1e-3);
  const Pose2 end = manoeuvre_pose(sample.model, sample.problem.frame, reach.parameters, {});
  CHECK((end.vector() - reach.pose.vector()).norm() < 1e-12);
  CHECK(std::hypot(end.x - goal.x, end.y - goal.y) == doctest::Approx(reach.gap_xy));
}

TEST_CASE("whole turns of the goal's heading make no difference") {
  const Sample sample;
  Pose2 goal{.x = 3.0, .y = 0.6, .theta = 0.4};
  const Reach plain = reach_goal(sample.problem, goal, sample.straight(3.0));
  goal.theta -= 4.0 * std::numbers::pi;
  const Reach turned = reach_goal(sample.problem, goal, sample.straight(3.0));
  CHECK(turned.reached);
  CHECK((turned.parameters - plain.parameters).norm() < 1e-9);
}

TEST_CASE("a goal out of reach is said to be, at the bounds and after no more steps than allowed") {
  const Sample sample;
  const Reach reach = reach_goal(sample.problem, {.x = 20.0}, sample.straight(3.0), {.iterations = 5});
  CHECK_FALSE(reach.reached);
  CHECK(reach.linearizations <= 5);
  CHECK(reach.gap_xy > 10.0);
  CHECK(reach.parameters[kLength] == doctest::Approx(6.0));
}

TEST_CASE("a guess beyond the bounds is taken from within them") {
  const Sample sample;
  ManoeuvreVector guess = sample.straight(50.0);
  guess.head<kCurvaturePoints>().setConstant(9.0);
  const Reach reach = reach_goal(sample.problem, {.x = 3.0, .y = 1.0, .theta = 0.5}, guess);
  CHECK((reach.parameters - sample.problem.bounds.low).minCoeff() >= 0.0);
  CHECK((sample.problem.bounds.high - reach.parameters).minCoeff() >= 0.0);
}

TEST_CASE("wider tolerances need no more linearisations") {
  const Sample sample;
  const Pose2 goal{.x = 3.0, .y = 0.6, .theta = 0.4};
  const Reach fine =
      reach_goal(sample.problem, goal, sample.straight(2.0), {.tolerance_xy = 1e-9, .tolerance_yaw = 1e-9});
  const Reach rough =
      reach_goal(sample.problem, goal, sample.straight(2.0), {.tolerance_xy = 0.1, .tolerance_yaw = 0.1});
  CHECK(fine.reached);
  CHECK(rough.reached);
  CHECK(rough.linearizations < fine.linearizations);
}

}  // namespace
}  // namespace slipwise
