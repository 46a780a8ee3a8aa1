// SPDX-License-Identifier: Apache-2.0
// Labels of surfaces: names, and a prior whose reliability is learned.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
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

void labelled(MotionLearner& learner, const std::string& label, double slip, std::uint64_t seed) {
  learner.start_drive({.label = label, .date = "2026-01-01"});
  push(learner, drive_on(slip, seed, kVisit, 1000.0 * static_cast<double>(seed)));
  learner.end_run();
}

std::string present_name(const MotionLearner& learner) {
  const SurfaceBank bank = learner.surfaces();
  return bank.present() ? bank.surfaces()[*bank.present()].name : "";
}

TEST_CASE("a label names a new surface, and a wrong one is overruled") {
  MotionLearner learner(surface_settings(true));
  const std::vector<std::string> labels{"ice", "grass", "ice"};
  const std::vector<double> slips{0.5, 0.1, 0.1};  // the last label is wrong
  for (std::size_t i = 0; i < labels.size(); ++i) {
    learner.start_drive({.label = labels[i], .date = "2026-01-01"});
    push(learner, drive_on(slips[i], 60 + i, kVisit, 1000.0 * static_cast<double>(i + 1)));
    learner.end_run();
  }
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.present());
  CHECK(bank.surfaces()[*bank.present()].name == "grass");
  CHECK(bank.surfaces().front().name == "ice");
  CHECK(bank.surfaces().front().last_seen == "2026-01-01");
  CHECK(bank.labels().reliability() < 0.95);
}

TEST_CASE("a surface that only had a number gets the name of a label") {
  MotionLearner learner(surface_settings(true));
  visit(learner, {0.1, 0.5});
  labelled(learner, "sand", 0.5, 63);
  CHECK(present_name(learner) == "sand");
  CHECK(learner.surfaces().surfaces().size() == 2);
  CHECK(learner.surfaces().labels().right == 1.0);
}

TEST_CASE("labels that were wrong are believed less") {
  MotionLearner learner(surface_settings(true));
  labelled(learner, "ice", 0.5, 60);
  labelled(learner, "grass", 0.1, 61);
  const double before = learner.surfaces().labels().reliability();
  labelled(learner, "grass", 0.5, 62);
  CHECK(present_name(learner) == "ice");
  CHECK(learner.surfaces().labels().reliability() < before);
  labelled(learner, "ice", 0.5, 63);
  CHECK(learner.surfaces().labels().all == learner.surfaces().labels().right + 1.0);
}

TEST_CASE("a right label makes the first predictions of a drive better") {
  MotionLearner told(surface_settings(true));
  for (std::size_t i = 0; i < 4; ++i) {
    labelled(told, i % 2 == 0 ? "ice" : "grass", i % 2 == 0 ? 0.5 : 0.1, 60 + i);
  }
  MotionLearner alone = MotionLearner::load(told.save());
  const std::size_t before = told.model().held_out.front().size();
  labelled(told, "ice", 0.5, 70);
  labelled(alone, "", 0.5, 70);
  CHECK(mean_yaw_error(told, before, 2) < 0.8 * mean_yaw_error(alone, before, 2));
}

TEST_CASE("a label while a drive goes on recalls its surface at once") {
  MotionLearner learner(surface_settings(true));
  labelled(learner, "ice", 0.5, 60);
  labelled(learner, "grass", 0.1, 61);
  learner.cue_surface("ice");
  push(learner, drive_on(0.5, 62, 10.0, 70000.0));
  learner.end_run();
  CHECK(present_name(learner) == "ice");
  const std::size_t visits = learner.surfaces().surfaces().front().visits;
  learner.cue_surface("ice");
  CHECK(learner.surfaces().surfaces().front().visits == visits);
}

void go_on_with_label(MotionLearner& learner, const std::string& label, double slip, std::uint64_t seed) {
  learner.cue_surface(label);
  push(learner, drive_on(slip, seed, 12.0, 100.0 * static_cast<double>(seed)));
  learner.end_run();
}

TEST_CASE("surfaces that labels name are kept apart where each stretch is short") {
  MotionLearner learner(surface_settings(true));
  learner.start_drive({.label = "ice"});
  for (std::uint64_t i = 0; i < 10; ++i) {
    go_on_with_label(learner, i % 2 == 0 ? "ice" : "grass", i % 2 == 0 ? 0.5 : 0.1, 60 + i);
  }
  learner.start_drive();
  const auto surfaces = learner.surfaces().surfaces();
  REQUIRE(surfaces.size() == 2);
  CHECK(surfaces[0].name == "ice");
  CHECK(surfaces[1].name == "grass");
  for (const Surface& each : surfaces) {
    CHECK(std::abs(each.seconds - 55.0) < 10.0);  // a stretch of 12 s has 11 whole segments
  }
}

TEST_CASE("a label before anything was driven replaces the one of the start") {
  MotionLearner learner(surface_settings(true));
  learner.start_drive({.label = "ice"});
  go_on_with_label(learner, "grass", 0.1, 60);
  learner.start_drive();
  REQUIRE(learner.surfaces().surfaces().size() == 1);
  CHECK(learner.surfaces().surfaces().front().name == "grass");
}

}  // namespace
}  // namespace slipwise
