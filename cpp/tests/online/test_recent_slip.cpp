// SPDX-License-Identifier: Apache-2.0
// What is kept of the slip now is what would be found again, and no longer than it holds.
#include <doctest/doctest.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/online/recent_slip.hpp"

namespace slipwise {
namespace {

struct Setting {
  MotionModel model{named_basis("edd-2"), {}};
  tests::SimulatedDrive drive = tests::simulate_drive(model, Eigen::Vector2d(-0.1, -0.3), {.seed = 4, .windows = 6});
  std::shared_ptr<const MotionPosterior> motion = std::make_shared<const MotionPosterior>(
      MotionPosterior{.model = model,
                      .estimate = {Eigen::Vector2d(-0.05, -0.2), Eigen::Matrix2d::Identity() * 1e-4},
                      .prior_std = Eigen::Vector2d(0.3, 0.3),
                      .noise = {.pose_std_xy = 0.02, .pose_std_yaw = 0.02},
                      .noise_scale = Eigen::Vector3d::Ones()});
  DisturbanceFilter disturbance{DisturbanceSettings{}};
  std::vector<DrivenSegment> segments;

  Setting() {
    for (const Segment& segment : drive.segments) {
      segments.push_back({.inputs = drive.inputs, .segment = segment});
    }
  }

  ExpectedPose next(const SlipNow& slip) const { return disturbance.predict(*motion, slip, segments[5]); }
  SlipNow at_once(std::size_t count) const { return disturbance.now(*motion, std::span(segments).first(count)); }
};

}  // namespace

TEST_CASE("where slip was is what is found of all segments at once, whatever was asked for before") {
  Setting s;
  const SegmentList three{&s.segments[0], &s.segments[1], &s.segments[2]};
  const SegmentList four{&s.segments[0], &s.segments[1], &s.segments[2], &s.segments[3]};
  RecentSlip kept;
  for (int i = 0; i < 3; ++i) {
    CHECK(s.next(kept.after(s.disturbance, s.motion, three)).pose == s.next(s.at_once(3)).pose);
    CHECK(s.next(kept.after(s.disturbance, s.motion, four)).pose == s.next(s.at_once(4)).pose);
    CHECK(s.next(kept.after(s.disturbance, s.motion, three)).covariance == s.next(s.at_once(3)).covariance);
  }
}

TEST_CASE("where slip was is kept for the posterior that was asked about, until another run begins") {
  Setting s;
  const SegmentList three{&s.segments[0], &s.segments[1], &s.segments[2]};
  RecentSlip kept;
  const SlipNow* first = &kept.after(s.disturbance, s.motion, three);
  CHECK(&kept.after(s.disturbance, s.motion, three) == first);
  MotionPosterior other = *s.motion;
  other.estimate.mean *= 1.5;
  const ExpectedPose by_other =
      s.next(kept.after(s.disturbance, std::make_shared<const MotionPosterior>(other), three));
  CHECK(by_other.pose != s.next(kept.after(s.disturbance, s.motion, three)).pose);
  // Segments of another run may end at the same stamps.
  const SegmentList again{&s.segments[3], &s.segments[4], &s.segments[5]};
  std::vector<DrivenSegment> same_ends;
  for (std::size_t i = 0; i < 3; ++i) {
    same_ends.push_back(*again[i]);
    same_ends.back().segment.end = three[i]->segment.end;
    same_ends.back().segment.start = three[i]->segment.start;
  }
  kept.restart();
  const SegmentList there{&same_ends[0], &same_ends[1], &same_ends[2]};
  CHECK(s.next(kept.after(s.disturbance, s.motion, there)).pose ==
        s.next(s.disturbance.now(*s.motion, same_ends)).pose);
}

}  // namespace slipwise
