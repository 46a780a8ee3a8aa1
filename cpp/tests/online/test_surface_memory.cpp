// SPDX-License-Identifier: Apache-2.0
// A learner that comes back to surfaces.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/recording.hpp"

namespace slipwise {
namespace {

/// Wheel speeds at 20 Hz and poses at 10 Hz of a robot that loses a part of its turns, from `begin` [s] on.
Recording drive(double yaw_slip, std::uint64_t seed, double seconds, double begin) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> speed(0.3, 1.2);
  std::uniform_real_distribution<double> yaw_rate(-0.8, 0.8);
  std::normal_distribution<double> normal;
  Recording run;
  BodyTwist wheels{};
  Pose2 pose;
  constexpr double kStep = 0.05;
  const auto steps = static_cast<int>(seconds / kStep);
  for (int i = 0; i < steps; ++i) {
    const double t = begin + kStep * i;
    if (i % 40 == 0) {
      wheels = {speed(random), 0.0, yaw_rate(random)};
    }
    run.wheels.push_back({t, wheels});
    if (i % 2 == 0) {
      run.poses.push_back({.t = t,
                           .x = pose.x + 0.005 * normal(random),
                           .y = pose.y + 0.005 * normal(random),
                           .yaw = std::remainder(pose.theta + 0.003 * normal(random), 6.283185307179586)});
    }
    const double turned = (1.0 - yaw_slip + 0.02 * normal(random)) * wheels.omega;
    pose = compose(pose, exp(Eigen::Vector3d(wheels.v * kStep, 0.0, turned * kStep)));
  }
  return run;
}

LearnerSettings settings(bool remember) {
  LearnerSettings all;
  all.stream.from_commands = false;
  all.stream.segment_length = 1.0;
  all.stream.horizons = {1.0};
  all.hypotheses.bases = {{"none", {}, {}, {}}, named_basis("edd-2"), named_basis("full-linear-6")};
  all.hypotheses.dynamics = false;
  all.hypotheses.average.surfaces.remember = remember;
  return all;
}

constexpr double kVisit = 90.0;  // [s]

/// Drives on one surface after the other; returns the names of those that were taken.
std::vector<std::string> visit(MotionLearner& learner, const std::vector<double>& yaw_slips) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < yaw_slips.size(); ++i) {
    learner.start_drive();
    push(learner, drive(yaw_slips[i], 50 + i, kVisit, 1000.0 * static_cast<double>(i + 1)));
    learner.end_run();
    const SurfaceBank bank = learner.surfaces();
    names.push_back(bank.present() ? bank.surfaces()[*bank.present()].name : "");
  }
  return names;
}

double mean_yaw_error(const MotionLearner& learner, std::size_t first, std::size_t count) {
  const auto held_out = learner.model().held_out.front();
  double sum = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    sum += std::abs(held_out[i].measured.z() - held_out[i].pose.z());
  }
  return sum / static_cast<double>(count);
}

TEST_CASE("a surface that comes back is recalled by its name") {
  MotionLearner learner(settings(true));
  const auto names = visit(learner, {0.1, 0.5, 0.1, 0.5});
  CHECK(names[0] != names[1]);
  CHECK(names[2] == names[0]);
  CHECK(names[3] == names[1]);
  CHECK(learner.surfaces().surfaces().size() == 2);
}

TEST_CASE("the first segments on a surface that comes back are predicted as its last ones were") {
  MotionLearner knows(settings(true));
  visit(knows, {0.1, 0.5, 0.1});
  MotionLearner forgets(settings(true));
  const std::size_t before = knows.model().held_out.front().size();
  visit(knows, {0.5});
  visit(forgets, {0.5});
  const double recalled = mean_yaw_error(knows, before, 10);
  CHECK(recalled < 0.5 * mean_yaw_error(forgets, 0, 10));
}

TEST_CASE("a change within a drive recalls the surface that it is a change to") {
  MotionLearner learner(settings(true));
  visit(learner, {0.1, 0.5, 0.1});
  push(learner, drive(0.5, 77, kVisit, 9000.0));
  learner.end_run();
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.present());
  CHECK(bank.surfaces()[*bank.present()].visits == 2);
  CHECK(bank.surfaces().size() == 2);
}

TEST_CASE("surfaces that cannot be told apart become one") {
  MotionLearner learner(settings(true));
  visit(learner, {0.3, 0.3, 0.3});
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.surfaces().size() == 1);
  CHECK(bank.surfaces().front().segments > 200);
}

TEST_CASE("a label names a new surface, and a wrong one is overruled") {
  MotionLearner learner(settings(true));
  const std::vector<std::string> labels{"ice", "grass", "ice"};
  const std::vector<double> slips{0.5, 0.1, 0.1};  // the last label is wrong
  for (std::size_t i = 0; i < labels.size(); ++i) {
    learner.start_drive({.label = labels[i], .date = "2026-01-01"});
    push(learner, drive(slips[i], 60 + i, kVisit, 1000.0 * static_cast<double>(i + 1)));
    learner.end_run();
  }
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.present());
  CHECK(bank.surfaces()[*bank.present()].name == "grass");
  CHECK(bank.surfaces().front().name == "ice");
  CHECK(bank.surfaces().front().last_seen == "2026-01-01");
  CHECK(bank.label_reliability() < 0.95);
}

TEST_CASE("on its first surface a learner learns as one without a memory") {
  MotionLearner remembers(settings(true));
  MotionLearner plain(settings(false));
  for (MotionLearner* learner : {&remembers, &plain}) {
    push(*learner, drive(0.1, 5, kVisit, 0.0));
    push(*learner, drive(0.1, 6, kVisit, 500.0));
    learner->end_run();
  }
  CHECK(remembers.model().known.motion->estimate.mean == plain.model().known.motion->estimate.mean);
  CHECK(remembers.model().known.motion->estimate.covariance == plain.model().known.motion->estimate.covariance);
}

TEST_CASE("the first change within a drive opens a second surface, and the first one is remembered as it was") {
  MotionLearner learner(settings(true));
  push(learner, drive(0.1, 5, kVisit, 0.0));
  push(learner, drive(0.5, 6, kVisit, 500.0));
  learner.end_run();
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.surfaces().size() == 2);
  const auto yaw_slip = [&](const Surface& surface) {
    const auto state = learner.on_surface(surface);
    const auto known = learner.model().known.motion;
    double value = 0.0;
    for (Eigen::Index i = 0; i < known->model.slip_size(); ++i) {
      const bool is_it = known->model.basis().parameter_name(static_cast<std::size_t>(i)) == "ang.w";
      value = is_it && state ? state->estimate.mean[i] : value;
    }
    return value;
  };
  CHECK(yaw_slip(bank.surfaces()[0]) == doctest::Approx(-0.1).epsilon(0.1));
  CHECK(yaw_slip(bank.surfaces()[1]) == doctest::Approx(-0.5).epsilon(0.1));
}

TEST_CASE("a learner without a memory starts a drive as it starts a run") {
  MotionLearner drives(settings(false));
  MotionLearner runs(settings(false));
  for (int i = 0; i < 2; ++i) {
    drives.start_drive();
    runs.start_run();
    push(drives, drive(0.3, 5, 40.0, 100.0 * i));
    push(runs, drive(0.3, 5, 40.0, 100.0 * i));
  }
  CHECK(drives.model().known.motion->estimate.mean == runs.model().known.motion->estimate.mean);
  CHECK(drives.surfaces().surfaces().empty());
}

TEST_CASE("surfaces are saved with the learner, in the middle of a trial too") {
  MotionLearner learner(settings(true));
  visit(learner, {0.1, 0.5});
  learner.start_drive();
  push(learner, drive(0.1, 91, 4.0, 5000.0));
  MotionLearner loaded = MotionLearner::load(learner.save());
  for (MotionLearner* each : {&learner, &loaded}) {
    push(*each, drive(0.1, 92, 40.0, 6000.0));
    each->end_run();
  }
  CHECK(loaded.model().known.motion->estimate.mean == learner.model().known.motion->estimate.mean);
  CHECK(loaded.surfaces().surfaces().size() == learner.surfaces().surfaces().size());
}

TEST_CASE("of more surfaces than are kept, the least used goes") {
  LearnerSettings few = settings(true);
  few.hypotheses.average.surfaces.most = 2;
  MotionLearner learner(few);
  visit(learner, {0.0, 0.5, 0.0, -0.4});
  CHECK(learner.surfaces().surfaces().size() == 2);
}

}  // namespace
}  // namespace slipwise
