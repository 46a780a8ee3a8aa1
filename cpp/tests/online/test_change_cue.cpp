// SPDX-License-Identifier: Apache-2.0
// "Something changed now": a true cue adapts faster, a false one costs little, with a memory of surfaces and without.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "online/drives_on_surfaces.hpp"

namespace slipwise {
namespace {

using tests::drive_on;
using tests::mean_yaw_error;
using tests::surface_settings;

constexpr double kBefore = 90.0;   // [s] driven before the cue
constexpr std::size_t kFirst = 8;  // predictions after it in which a change is felt
constexpr std::size_t kMinute = 60;
constexpr std::uint64_t kSeeds = 6;

struct Errors {
  double told = 0.0;
  double alone = 0.0;
};

struct Costs {
  Errors of_true;
  Errors of_false;
};

/// Adds the mean yaw errors with a cue and without, on a drive with another slip, or the same one, after `learned`.
void add_errors(Errors& errors, const std::string& learned, double slip, std::uint64_t seed, std::size_t count) {
  for (const bool cue : {true, false}) {
    MotionLearner learner = MotionLearner::load(learned);
    const std::size_t before = learner.model().held_out.front().size();
    if (cue) {
      learner.cue_surface("");
    }
    learner.start_run();
    push(learner, drive_on(slip, 100 + seed, static_cast<double>(count) + 10.0, 2000.0));
    learner.end_run();
    (cue ? errors.told : errors.alone) += mean_yaw_error(learner, before, count) / kSeeds;
  }
}

TEST_CASE("a true cue makes predictions after a change better, a false one costs a few percent of a minute's error") {
  for (const bool remember : {false, true}) {
    CAPTURE(remember);
    Costs costs;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      MotionLearner learner(surface_settings(remember));
      push(learner, drive_on(0.1, seed, kBefore, 1000.0));
      learner.end_run();
      const std::string learned = learner.save();
      add_errors(costs.of_true, learned, 0.25, seed, kFirst);
      add_errors(costs.of_false, learned, 0.1, seed, kMinute);
    }
    CHECK(costs.of_true.told < 0.9 * costs.of_true.alone);
    CHECK(costs.of_false.told < 1.05 * costs.of_false.alone);
  }
}

}  // namespace
}  // namespace slipwise
