// SPDX-License-Identifier: Apache-2.0
// A recording pushed at once is learned as its rows are; its segments and poses are those that are learned.
#include <doctest/doctest.h>

#include <array>

#include "slipwise/online/recording.hpp"
#include "streamed_robot.hpp"

namespace slipwise {

TEST_CASE("the segments of recorded runs are those that a learner learns, and none spans two runs") {
  const std::array runs{tests::streamed_robot(1, 20.0), tests::streamed_robot(2, 15.0, 500.0)};
  const LearnerSettings settings = tests::learner_settings(true);
  MotionLearner learner(settings);
  for (const Recording& run : runs) {
    learner.start_run();
    push(learner, run);
  }
  const CutRuns cut = cut_segments(settings.stream, runs);
  CHECK(cut.segments.size() == learner.model().segments);
  REQUIRE(cut.run.size() == cut.segments.size());
  for (std::size_t i = 0; i < cut.segments.size(); ++i) {
    const double begins = cut.run[i] == 0 ? 100.0 : 500.0;
    CHECK(cut.segments[i].segment.start >= begins);
    CHECK(cut.segments[i].segment.end <= begins + (cut.run[i] == 0 ? 20.1 : 15.1));
  }
}

TEST_CASE("of the poses of a recording, an outlier is rejected and the others keep their order") {
  Recording run = tests::streamed_robot(3, 20.0);
  run.poses[100].x += 50.0;
  const GatedPoses gated = gate_poses(run, 0.5);
  CHECK(gated.accepted.size() == run.poses.size() - 1);
  for (std::size_t i = 1; i < gated.accepted.size(); ++i) {
    CHECK(gated.accepted[i].t > gated.accepted[i - 1].t);
    CHECK(gated.accepted[i].t != run.poses[100].t);
  }
}

}  // namespace slipwise
