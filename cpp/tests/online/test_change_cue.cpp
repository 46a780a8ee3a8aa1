// SPDX-License-Identifier: Apache-2.0
// "Something changed now": a true cue adapts faster, a false one costs little, with a memory of surfaces and without.
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>

#include "online/drives_on_surfaces.hpp"

namespace slipwise {
namespace {

using tests::drive_on;
using tests::mean_yaw_error;
using tests::surface_settings;

constexpr double kBefore = 90.0;   // [s] driven before the cue
constexpr std::size_t kFirst = 8;  // predictions after it in which a change is felt
constexpr std::uint64_t kSeeds = 12;

struct Errors {
  double told = 0.0;
  double alone = 0.0;
};

/// Mean yaw errors after a cue, and without it, over drives whose slip goes from a tenth to `after`.
Errors after_cue(bool remember, double after, std::size_t count) {
  Errors errors;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    MotionLearner told(surface_settings(remember));
    push(told, drive_on(0.1, seed, kBefore, 1000.0));
    told.end_run();
    MotionLearner alone = MotionLearner::load(told.save());
    const std::size_t before = told.model().held_out.front().size();
    told.cue_surface("");
    for (MotionLearner* learner : {&told, &alone}) {
      learner->start_run();
      push(*learner, drive_on(after, 100 + seed, kBefore, 2000.0));
      learner->end_run();
    }
    errors.told += mean_yaw_error(told, before, count) / kSeeds;
    errors.alone += mean_yaw_error(alone, before, count) / kSeeds;
  }
  return errors;
}

TEST_CASE("a true cue makes the predictions after a change better") {
  for (const bool remember : {false, true}) {
    const Errors errors = after_cue(remember, 0.25, kFirst);
    CHECK(errors.told < 0.9 * errors.alone);
  }
}

TEST_CASE("a false cue costs a few percent of the next minute's error") {
  for (const bool remember : {false, true}) {
    const Errors errors = after_cue(remember, 0.1, 60);
    CHECK(errors.told < 1.05 * errors.alone);
  }
}

}  // namespace
}  // namespace slipwise
