// SPDX-License-Identifier: Apache-2.0
// What is kept of the slip now is what would be found again, and no longer than it holds.
#include <doctest/doctest.h>

#include <memory>

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
  Knowledge known{.until = 0.0,
                  .motion = motion,
                  .slip = motion,
                  .disturbance = std::make_shared<const ColouredSlip>(ColouredSlipSettings{})};
  std::vector<DrivenSegment> segments;

  Setting() {
    for (const Segment& segment : drive.segments) {
      segments.push_back({.inputs = drive.inputs, .segment = segment});
    }
  }

  ExpectedPose next(const SlipNow& slip) const { return known.disturbance->predict(*known.motion, slip, segments[5]); }
};

}  // namespace

TEST_CASE("what was found is kept until a segment or the posterior changes, and is what would be found again") {
  Setting s;
  const SegmentList three{&s.segments[0], &s.segments[1], &s.segments[2]};
  const SegmentList four{&s.segments[0], &s.segments[1], &s.segments[2], &s.segments[3]};
  RecentSlip kept;
  CHECK(!kept.has(s.known, three));
  const ExpectedPose first = s.next(kept.now(s.known, three));
  CHECK(kept.has(s.known, three));
  CHECK(!kept.has(s.known, four));
  CHECK(s.next(kept.now(s.known, three)).pose == first.pose);
  CHECK(first.pose == s.next(slip_after(*s.known.disturbance, *s.known.motion, three)).pose);
  CHECK(s.next(kept.now(s.known, four)).pose != first.pose);
  s.known.motion = std::make_shared<const MotionPosterior>(*s.motion);
  CHECK(!kept.has(s.known, four));
}

TEST_CASE("segments followed one by one are those learned of at once") {
  Setting s;
  const SlipNow at_once = s.known.disturbance->now(*s.motion, std::span(s.segments).first(3));
  const SlipNow followed =
      slip_after(*s.known.disturbance, *s.motion, {&s.segments[0], &s.segments[1], &s.segments[2]});
  CHECK(s.next(at_once).pose == s.next(followed).pose);
  CHECK(s.next(at_once).covariance == s.next(followed).covariance);
}

}  // namespace slipwise
