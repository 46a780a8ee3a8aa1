// SPDX-License-Identifier: Apache-2.0
// A learner that comes back to surfaces.
#include <doctest/doctest.h>

#include <algorithm>
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

TEST_CASE("a surface that comes back is recalled by its name") {
  MotionLearner learner(surface_settings(true));
  const auto names = visit(learner, {0.1, 0.5, 0.1, 0.5});
  CHECK(names[0] != names[1]);
  CHECK(names[2] == names[0]);
  CHECK(names[3] == names[1]);
  CHECK(learner.surfaces().surfaces().size() == 2);
}

TEST_CASE("the first segments on a surface that comes back are predicted as its last ones were") {
  MotionLearner knows(surface_settings(true));
  visit(knows, {0.1, 0.5, 0.1});
  MotionLearner forgets(surface_settings(true));
  const std::size_t before = knows.model().held_out.front().size();
  visit(knows, {0.5});
  visit(forgets, {0.5});
  const double recalled = mean_yaw_error(knows, before, 10);
  CHECK(recalled < 0.5 * mean_yaw_error(forgets, 0, 10));
}

TEST_CASE("a change within a drive recalls the surface that it is a change to") {
  MotionLearner learner(surface_settings(true));
  visit(learner, {0.1, 0.5, 0.1});
  push(learner, drive_on(0.5, 77, kVisit, 9000.0));
  learner.end_run();
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.present());
  CHECK(bank.surfaces()[*bank.present()].visits == 2);
  CHECK(bank.surfaces().size() == 2);
}

TEST_CASE("each window says how probable the surfaces are, and each recall when it was decided") {
  MotionLearner learner(surface_settings(true));
  visit(learner, {0.1, 0.5});
  learner.events();
  learner.surface_events();
  visit(learner, {0.1});
  double sure_since = 0.0;
  for (const LearnerEvent& event : learner.events()) {
    if (event.kind == LearnerEvent::Kind::SegmentLearned) {
      double sum = 0.0;
      for (const SurfaceProbability& each : event.surfaces) {
        sum += each.probability;
        sure_since = sure_since == 0.0 && each.name == "surface 1" && each.probability > 0.98 ? event.t : sure_since;
      }
      CHECK(sum == doctest::Approx(1.0));
    }
  }
  const auto happened = learner.surface_events();
  const auto recalled = std::ranges::find(happened, SurfaceEvent::Kind::Recalled,
                                          [](const DatedSurfaceEvent& each) { return each.event.kind; });
  REQUIRE(recalled != happened.end());
  CHECK(recalled->event.name == "surface 1");
  CHECK(recalled->t == doctest::Approx(sure_since));
  CHECK(learner.surface_events().empty());
}

TEST_CASE("without a memory no window speaks of surfaces") {
  MotionLearner learner(surface_settings(false));
  push(learner, drive_on(0.3, 5, 20.0, 0.0));
  learner.end_run();
  for (const LearnerEvent& event : learner.events()) {
    CHECK(event.surfaces.empty());
  }
}

TEST_CASE("surfaces that cannot be told apart become one") {
  MotionLearner learner(surface_settings(true));
  visit(learner, {0.3, 0.3, 0.3});
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.surfaces().size() == 1);
  CHECK(bank.surfaces().front().segments > 200);
}

TEST_CASE("on its first surface a learner learns as one without a memory") {
  MotionLearner remembers(surface_settings(true));
  MotionLearner plain(surface_settings(false));
  for (MotionLearner* learner : {&remembers, &plain}) {
    push(*learner, drive_on(0.1, 5, kVisit, 0.0));
    push(*learner, drive_on(0.1, 6, kVisit, 500.0));
    learner->end_run();
  }
  CHECK(remembers.model().known.motion->estimate.mean == plain.model().known.motion->estimate.mean);
  CHECK(remembers.model().known.motion->estimate.covariance == plain.model().known.motion->estimate.covariance);
}

TEST_CASE("the first change within a drive opens a second surface, and the first one is remembered as it was") {
  MotionLearner learner(surface_settings(true));
  push(learner, drive_on(0.1, 5, kVisit, 0.0));
  push(learner, drive_on(0.5, 6, kVisit, 500.0));
  learner.end_run();
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.surfaces().size() == 2);
  const auto yaw_slip = [&](const Surface& surface) {
    const auto known_there = slip_on(learner.learned().hypotheses().structures(), surface, Structure::Joint);
    const auto known = learner.model().known.motion;
    double value = 0.0;
    for (Eigen::Index i = 0; i < known->model.slip_size(); ++i) {
      const bool is_it = known->model.basis().parameter_name(static_cast<std::size_t>(i)) == "ang.w";
      value = is_it && known_there ? known_there->state.estimate.mean[i] : value;
    }
    return value;
  };
  CHECK(yaw_slip(bank.surfaces()[0]) == doctest::Approx(-0.1).epsilon(0.1));
  CHECK(yaw_slip(bank.surfaces()[1]) == doctest::Approx(-0.5).epsilon(0.1));
}

TEST_CASE("a learner without a memory starts a drive as it starts a run") {
  MotionLearner drives(surface_settings(false));
  MotionLearner runs(surface_settings(false));
  for (int i = 0; i < 2; ++i) {
    drives.start_drive();
    runs.start_run();
    push(drives, drive_on(0.3, 5, 40.0, 100.0 * i));
    push(runs, drive_on(0.3, 5, 40.0, 100.0 * i));
  }
  CHECK(drives.model().known.motion->estimate.mean == runs.model().known.motion->estimate.mean);
  CHECK(drives.surfaces().surfaces().empty());
}

TEST_CASE("surfaces are saved with the learner, in the middle of a trial too") {
  MotionLearner learner(surface_settings(true));
  visit(learner, {0.1, 0.5});
  learner.start_drive();
  push(learner, drive_on(0.1, 91, 4.0, 5000.0));
  MotionLearner loaded = MotionLearner::load(learner.save());
  for (MotionLearner* each : {&learner, &loaded}) {
    push(*each, drive_on(0.1, 92, 40.0, 6000.0));
    each->end_run();
  }
  CHECK(loaded.model().known.motion->estimate.mean == learner.model().known.motion->estimate.mean);
  CHECK(loaded.surfaces().surfaces().size() == learner.surfaces().surfaces().size());
}

TEST_CASE("an entry says how long, how often, when and how fast its surface was driven") {
  MotionLearner learner(surface_settings(true));
  for (const std::string date : {"2026-01-01", "2026-02-01"}) {
    learner.start_drive({.label = "hall", .date = date});
    push(learner, drive_on(0.1, date.size(), kVisit, date == "2026-01-01" ? 1000.0 : 2000.0));
    learner.end_run();
  }
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.surfaces().size() == 1);
  const Surface& hall = bank.surfaces().front();
  CHECK(hall.last_seen == "2026-02-01");
  CHECK(hall.visits == 2);
  CHECK(hall.seconds > 1.8 * kVisit);
  CHECK(hall.seconds <= 2.0 * kVisit);
  CHECK(hall.speeds.v == doctest::Approx(1.15).epsilon(0.1));
  CHECK(hall.speeds.omega == doctest::Approx(0.7).epsilon(0.15));
}

std::vector<std::string> names_after(const std::vector<std::string>& labels) {
  LearnerSettings doubtful = surface_settings(true);
  doubtful.hypotheses.average.surfaces.false_alarm = 1e-12;  // nothing is ever certain, and much is alike
  MotionLearner learner(doubtful);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    learner.start_drive({.label = labels[i], .date = ""});
    push(learner, drive_on(i == 0 ? 0.3 : 0.4, 80 + i, kVisit, 1000.0 * static_cast<double>(i + 1)));
    learner.end_run();
  }
  std::vector<std::string> names;
  const SurfaceBank bank = learner.surfaces();
  for (const Surface& surface : bank.surfaces()) {
    names.push_back(surface.name);
  }
  return names;
}

TEST_CASE("surfaces that somebody names apart stay two where others would become one") {
  CHECK(names_after({"", ""}) == std::vector<std::string>{"surface 1"});
  CHECK(names_after({"hall", "corridor"}) == std::vector<std::string>{"hall", "corridor"});
}

TEST_CASE("of more surfaces than are kept, the least used goes") {
  LearnerSettings few = surface_settings(true);
  few.hypotheses.average.surfaces.most = 2;
  MotionLearner learner(few);
  visit(learner, {0.0, 0.5, 0.0, -0.4});
  CHECK(learner.surfaces().surfaces().size() == 2);
}

}  // namespace
}  // namespace slipwise
