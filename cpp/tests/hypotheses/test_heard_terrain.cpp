// SPDX-License-Identifier: Apache-2.0
// What a sensor says of the terrain is a prior for the surfaces that it said it on before.
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

TerrainAnswer said(const std::string& name) {
  TerrainAnswer answer{.classes = {"brown", "green", "white"}, .probability = Eigen::Vector3d::Constant(0.05)};
  answer.probability[std::ranges::find(answer.classes, name) - answer.classes.begin()] = 0.9;
  return answer;
}

/// A drive in which a sensor says the same every five seconds.
void heard(MotionLearner& learner, const std::string& name, double slip, std::uint64_t seed, double seconds = kVisit) {
  const double begin = 1000.0 * static_cast<double>(seed);
  learner.start_drive({});
  const Recording all = drive_on(slip, seed, seconds, begin);
  const auto part_of = [&](const auto& samples, double since) {
    auto part = samples;
    std::erase_if(part, [&](const auto& sample) { return sample.t < since || sample.t >= since + 5.0; });
    return part;
  };
  for (double since = begin; since < begin + seconds; since += 5.0) {
    if (!name.empty() && since > begin) {
      learner.cue_terrain(said(name));
    }
    Recording part;
    part.wheels = part_of(all.wheels, since);
    part.poses = part_of(all.poses, since);
    push(learner, part);
  }
  learner.end_run();
}

std::string named_terrain(const MotionLearner& learner) {
  const SurfaceBank bank = learner.surfaces();
  return bank.present() ? bank.surfaces()[*bank.present()].name : "";
}

/// How probable surfaces were when the first segment after this drive's begin was learned.
std::vector<SurfaceProbability> first_probabilities(MotionLearner& learner, const Recording& drive) {
  learner.events();
  push(learner, drive);
  learner.end_run();
  for (const LearnerEvent& event : learner.events()) {
    if (!event.surfaces.empty()) {
      return event.surfaces;
    }
  }
  return {};
}

/// Ice is white and grass green, twice each.
MotionLearner taught() {
  MotionLearner learner(surface_settings(true));
  for (std::uint64_t i = 0; i < 4; ++i) {
    heard(learner, i % 2 == 0 ? "white" : "green", i % 2 == 0 ? 0.5 : 0.1, 60 + i);
  }
  return learner;
}

TEST_CASE("what was said on a surface is counted with it, one for each visit") {
  const MotionLearner learner = taught();
  const SurfaceBank bank = learner.surfaces();
  REQUIRE(bank.surfaces().size() == 2);
  ClassCounts classes = bank.surfaces().front().classes;
  const double white = count_in(classes, "white");
  const double green = count_in(classes, "green");
  CHECK(white + green + count_in(classes, "brown") == doctest::Approx(2.0).epsilon(0.01));
  CHECK(white > 10.0 * green);
}

TEST_CASE("a class that was said on a surface makes the first predictions on it better") {
  MotionLearner told = taught();
  MotionLearner alone = MotionLearner::load(told.save());
  const std::size_t before = told.model().held_out.front().size();
  for (MotionLearner* each : {&told, &alone}) {
    each->start_drive({});
    if (each == &told) {
      each->cue_terrain(said("white"));
    }
    push(*each, drive_on(0.5, 70, kVisit, 70000.0));
    each->end_run();
  }
  CHECK(mean_yaw_error(told, before, 2) < 0.8 * mean_yaw_error(alone, before, 2));
}

TEST_CASE("another class amid a drive lets the surfaces compete, and segments decide") {
  MotionLearner learner = taught();
  heard(learner, "green", 0.1, 71, 40.0);
  learner.start_run();
  learner.cue_terrain(said("white"));
  CHECK(first_probabilities(learner, drive_on(0.5, 72, 20.0, 72000.0)).size() > 1);
  CHECK(named_terrain(learner) == learner.surfaces().surfaces().front().name);
}

TEST_CASE("a wrong class is overruled, and is worth less from then on") {
  MotionLearner learner = taught();
  const auto likelihood = [&learner] {
    const Surface ice = learner.surfaces().surfaces().front();
    return likelihood_of({{"brown", 0.0}, {"green", 1.0}, {"white", 0.0}, {kUnknownClass, 0.0}},
                         {ice.name, ice.classes});
  };
  const double before = likelihood();
  heard(learner, "green", 0.5, 73);
  CHECK(named_terrain(learner) == learner.surfaces().surfaces().front().name);
  CHECK(likelihood() > 2.0 * before);
}

TEST_CASE("many answers of one drive are one cue") {
  MotionLearner once = taught();
  MotionLearner often = MotionLearner::load(once.save());
  once.start_drive({});
  often.start_drive({});
  once.cue_terrain(said("green"));
  for (int i = 0; i < 50; ++i) {
    often.cue_terrain(said("green"));
  }
  const Recording drive = drive_on(0.1, 74, 3.0, 74000.0);
  const auto by_one = first_probabilities(once, drive);
  const auto by_many = first_probabilities(often, drive);
  REQUIRE(by_one.size() > 1);
  CHECK(by_many.front().probability == doctest::Approx(by_one.front().probability));
}

TEST_CASE("where nothing is remembered, or no other surface is known, nothing changes") {
  MotionLearner plain(surface_settings(false));
  plain.cue_terrain(said("white"));
  CHECK(plain.surfaces().surfaces().empty());
  MotionLearner first(surface_settings(true));
  first.cue_terrain(said("white"));
  CHECK(first_probabilities(first, drive_on(0.1, 75, 5.0, 75000.0)).size() == 1);
  CHECK_THROWS_AS(first.cue_terrain({{"ice"}, Eigen::VectorXd::Constant(1, 0.5), 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
