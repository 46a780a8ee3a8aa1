// SPDX-License-Identifier: Apache-2.0
// A learner that goes on from what another one knew, and two memories that are joined.
#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "online/drives_on_surfaces.hpp"

namespace slipwise {
namespace {

using tests::drive_on;
using tests::kVisit;
using tests::mean_yaw_error;
using tests::surface_settings;
using tests::visit;

KnownBefore handed_out(const MotionLearner& learner) {
  KnownBefore known{.model = *learner.model().known.slip, .surfaces = {}, .labels = {}};
  const SurfaceBank bank = learner.surfaces();
  for (const Surface& surface : bank.surfaces()) {
    const auto there = slip_on(learner.learned().hypotheses().structures(), surface, Structure::Joint);
    REQUIRE(there);
    known.surfaces.push_back({.facts = surface, .memory = there->memory});
  }
  return known;
}

MotionLearner visited(const std::vector<double>& slips) {
  MotionLearner learner(surface_settings(true));
  visit(learner, slips);
  return learner;
}

TEST_CASE("what is known of the slip now is said without a memory of surfaces, too, and another begins with it") {
  MotionLearner other(surface_settings(false));
  push(other, drive_on(0.5, 11, kVisit, 0.0));
  other.end_run();
  CHECK(other.surfaces().surfaces().empty());
  const auto now = slip_now(other.learned().hypotheses().structures(), Structure::Joint);
  REQUIRE(now);
  CHECK(now->memory.bases.size() == now->memory.memory.slips.size());
  const MotionPosterior known = *other.model().known.slip;
  CHECK((now->state.estimate.mean - known.estimate.mean).norm() < 1e-9);
  MotionLearner begins(surface_settings(false));
  begins.begin_with({.model = known, .surfaces = {{.facts = {.name = "fleet"}, .memory = now->memory}}, .labels = {}},
                    other.model().known.disturbance->law(), false);
  MotionLearner forgets(surface_settings(false));
  for (MotionLearner* learner : {&begins, &forgets}) {
    push(*learner, drive_on(0.5, 77, kVisit, 9000.0));
    learner->end_run();
  }
  CHECK(mean_yaw_error(begins, 0, 10) < 0.5 * mean_yaw_error(forgets, 0, 10));
}

TEST_CASE("a learner that begins with surfaces of another predicts their first segments as that one would") {
  const MotionLearner other = visited({0.1, 0.5, 0.1});
  MotionLearner goes_on = other;
  MotionLearner begins(surface_settings(true));
  begins.begin_with(handed_out(other), other.model().known.disturbance->law(), false);
  MotionLearner forgets(surface_settings(true));
  const std::size_t before = goes_on.model().held_out.front().size();
  for (MotionLearner* learner : {&goes_on, &begins, &forgets}) {
    learner->start_drive();
    push(*learner, drive_on(0.5, 77, kVisit, 9000.0));
    learner->end_run();
  }
  CHECK(begins.surfaces().surfaces().size() == 2);
  CHECK(begins.surfaces().surfaces().back().visits == 2);
  CHECK(mean_yaw_error(begins, 0, 10) < 1.1 * mean_yaw_error(goes_on, before, 10));
  CHECK(mean_yaw_error(begins, 0, 10) < 0.5 * mean_yaw_error(forgets, 0, 10));
}

/// How far the surfaces are off that another learner takes in, in their standard deviations, at most.
double off_after_handing_over(const LearnerSettings& settings) {
  MotionLearner other(settings);
  visit(other, {0.1, 0.5});
  MotionLearner begins(settings);
  begins.begin_with(handed_out(other), other.model().known.disturbance->law(), false);
  const auto before = other.surfaces().surfaces();
  const auto after = begins.surfaces().surfaces();
  REQUIRE(after.size() == 2);
  double off = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const AverageState was = slip_on(other.learned().hypotheses().structures(), before[i], Structure::Joint)->state;
    const AverageState is = slip_on(begins.learned().hypotheses().structures(), after[i], Structure::Joint)->state;
    const Eigen::VectorXd std = was.estimate.covariance.diagonal().cwiseSqrt();
    off = std::max(off, (is.estimate.mean - was.estimate.mean).cwiseQuotient(std).cwiseAbs().maxCoeff());
    CHECK(is.noise_scale.isApprox(was.noise_scale, 1e-9));
    CHECK(after[i].name == before[i].name);
  }
  return off;
}

TEST_CASE("a surface that is handed over and taken in again is the same one, but for what bases think of the robot") {
  LearnerSettings settings = surface_settings(true);
  CHECK(off_after_handing_over(settings) < 0.01);
  settings.hypotheses.bases = {named_basis("full-linear-6")};
  CHECK(off_after_handing_over(settings) < 1e-9);
}

TEST_CASE("of two memories, surfaces that cannot be told apart become one") {
  MotionLearner begins(surface_settings(true));
  const MotionLearner first = visited({0.1, 0.5});
  begins.begin_with(handed_out(first), first.model().known.disturbance->law(), false);
  const std::vector<std::string> names = begins.add_surfaces(handed_out(visited({0.5, -0.4})));
  const auto surfaces = begins.surfaces().surfaces();
  REQUIRE(surfaces.size() == 3);
  CHECK(surfaces[1].visits == 2);
  CHECK(names[0] == "surface 1 (2)");
  const auto events = begins.surface_events();
  REQUIRE(events.size() == 1);
  CHECK(events[0].event.name == "surface 2");
  CHECK(events[0].event.other == "surface 1 (2)");
  const double once =
      slip_on(first.learned().hypotheses().structures(), first.surfaces().surfaces()[1], Structure::Joint)

          ->state.estimate.covariance.trace();
  CHECK(slip_on(begins.learned().hypotheses().structures(), surfaces[1], Structure::Joint)
            ->state.estimate.covariance.trace() < once);
}

TEST_CASE("a learner begins with surfaces before it has learned anything, or not at all") {
  MotionLearner learned = visited({0.1});
  const KnownBefore known = handed_out(learned);
  CHECK_THROWS_AS(learned.begin_with(known, {}, false), std::invalid_argument);
  MotionLearner fresh(surface_settings(true));
  KnownBefore wrong = known;
  wrong.surfaces.front().memory.memory.slips.back().mean.conservativeResize(1);
  CHECK_THROWS_AS(fresh.begin_with(wrong, learned.model().known.disturbance->law(), false), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
