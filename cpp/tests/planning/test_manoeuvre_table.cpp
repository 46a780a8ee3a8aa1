// SPDX-License-Identifier: Apache-2.0
// The table of manoeuvres: where its entries lead, which are nearest, and how long they are.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "sample_manoeuvres.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/planning/manoeuvre_table.hpp"

namespace slipwise {
namespace {

constexpr double kTurnLength = 1.0;

struct Sample {
  tests::SampleModel robot = tests::sample_model(named_basis("edd-2"), false);
  PlanningModel model{robot.motion, robot.parameters};
  ReachProblem problem{.model = model,
                       .frame = {.speeds = {.start = 0.0, .cruise = 1.0, .end = 0.0}, .commands = 12},
                       .start = {},
                       .bounds = tests::sample_bounds(5.0)};
};

double apart(const Pose2& a, const Pose2& b) {
  return std::hypot(std::hypot(a.x - b.x, a.y - b.y), kTurnLength * wrap_angle(a.theta - b.theta));
}

TEST_CASE("every entry leads where it says, within the bounds") {
  const Sample sample;
  const ManoeuvreTable table(sample.problem, 800);
  CHECK(table.size() > 300);
  const auto entries = table.nearest({.x = 2.0, .y = 0.5, .theta = 0.3}, 50, kTurnLength);
  REQUIRE(entries.size() > 20);
  for (const auto& entry : entries) {
    const Pose2 end = manoeuvre_pose(sample.model, sample.problem.frame, entry.parameters, {});
    CHECK((end.vector() - entry.end.vector()).norm() < 1e-12);
    CHECK((entry.parameters - sample.problem.bounds.low).minCoeff() >= 0.0);
    CHECK((sample.problem.bounds.high - entry.parameters).minCoeff() >= 0.0);
  }
}

TEST_CASE("the nearest entries come nearest first, no more than asked for") {
  const Sample sample;
  const ManoeuvreTable table(sample.problem, 2000);
  const Pose2 goal{.x = 2.5, .y = -0.4, .theta = -0.2};
  const auto entries = table.nearest(goal, 6, kTurnLength);
  REQUIRE(entries.size() == 6);
  double before = 0.0;
  for (const auto& entry : entries) {
    CHECK(apart(entry.end, goal) >= before);
    before = apart(entry.end, goal);
  }
  CHECK(before < 1.5);
}

TEST_CASE("an entry is found from its own end, whole turns away too") {
  const Sample sample;
  const ManoeuvreTable table(sample.problem, 500);
  const auto any = table.nearest({.x = 2.0, .y = 0.0, .theta = 0.0}, 1, kTurnLength);
  REQUIRE(any.size() == 1);
  Pose2 end = any.front().end;
  for (int turns = -1; turns <= 1; ++turns) {
    end.theta = any.front().end.theta + 2.0 * std::numbers::pi * turns;
    const auto again = table.nearest(end, 1, kTurnLength);
    REQUIRE(again.size() == 1);
    CHECK(again.front().parameters == any.front().parameters);
  }
}

TEST_CASE("the same problem gives the same table, and more samples fill more places") {
  const Sample sample;
  const ManoeuvreTable table(sample.problem, 600), again(sample.problem, 600), longer(sample.problem, 4000);
  const Pose2 goal{.x = 3.0, .y = 0.1, .theta = 0.0};
  const auto one = table.nearest(goal, 3, kTurnLength), other = again.nearest(goal, 3, kTurnLength);
  REQUIRE(one.size() == other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(one[i].parameters == other[i].parameters);
  }
  CHECK(longer.size() > table.size());
}

TEST_CASE("a goal far beyond the longest manoeuvre has none near it") {
  const Sample sample;
  const ManoeuvreTable table(sample.problem, 500);
  CHECK(table.nearest({.x = 100.0}, 5, kTurnLength).empty());
  CHECK(table.nearest({.x = -1e300}, 5, kTurnLength).empty());
}

}  // namespace
}  // namespace slipwise
