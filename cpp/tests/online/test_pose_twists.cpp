// SPDX-License-Identifier: Apache-2.0
#include "slipwise/online/pose_twists.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <optional>
#include <vector>

#include "slipwise/lie/se2.hpp"

using slipwise::adjoint;
using slipwise::BodyTwist;
using slipwise::compose;
using slipwise::exp;
using slipwise::InputBuffer;
using slipwise::Pose2;
using slipwise::PoseTwists;
using slipwise::TimedPose;
using slipwise::TwistStretch;

namespace {

const Eigen::Vector3d kTwist(0.8, 0.05, -0.4);

/// The stretches of poses that come each `interval` [s] for `seconds`, none between `gap` and half a second later.
std::vector<TwistStretch> stretches(double interval, double seconds, const Pose2& sensor = {}, double gap = 1e9) {
  InputBuffer commands(1.0);
  PoseTwists twists({}, sensor);
  std::vector<TwistStretch> all;
  const auto add = [&](const std::vector<TwistStretch>& more) { all.insert(all.end(), more.begin(), more.end()); };
  for (int i = 0; i * interval <= seconds; ++i) {
    const double t = i * interval;
    commands.push({t, {.v = 0.5}});
    if (t > gap && t < gap + 0.5) {
      continue;
    }
    const Pose2 at = compose(exp(kTwist * t), sensor);
    add(twists.push({.pose = {.t = t, .x = at.x, .y = at.y, .yaw = at.theta}, .interval = interval, .gap = interval},
                    commands));
  }
  add(twists.finish(commands));
  return all;
}

void check_twist(const TwistStretch& stretch) {
  for (const BodyTwist& twist : stretch.twist) {
    CHECK(twist.v == doctest::Approx(kTwist.x()));
    CHECK(twist.vy == doctest::Approx(kTwist.y()));
    CHECK(twist.omega == doctest::Approx(kTwist.z()));
  }
}

}  // namespace

TEST_CASE("a steady twist is found, in stretches of a second that join") {
  const std::vector<TwistStretch> found = stretches(0.05, 3.0);
  REQUIRE(found.size() == 3);
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].start == doctest::Approx(static_cast<double>(i)));
    CHECK(found[i].end == doctest::Approx(static_cast<double>(i + 1)));
    REQUIRE(found[i].t.size() == 5);
    CHECK(found[i].t.front() == doctest::Approx(found[i].start + 0.1));
    check_twist(found[i]);
  }
}

TEST_CASE("it is that of base_link, wherever the sensor sits") {
  for (const TwistStretch& stretch : stretches(0.1, 2.0, {0.6, -0.3, 1.0})) {
    check_twist(stretch);
  }
}

TEST_CASE("no twist goes over a gap") {
  const std::vector<TwistStretch> found = stretches(0.1, 4.0, {}, 1.75);
  REQUIRE(found.size() > 2);
  for (const TwistStretch& stretch : found) {
    const bool over = stretch.start < 1.75 && stretch.end > 2.2;
    CHECK_FALSE(over);
    check_twist(stretch);
  }
}

TEST_CASE("poses that are rare give none") { CHECK(stretches(0.5, 20.0).empty()); }

TEST_CASE("commands are needed from the stretch's start on") {
  InputBuffer commands(1.0);
  PoseTwists twists({}, {});
  CHECK(twists.begins() == std::numeric_limits<double>::infinity());
  for (int i = 0; i < 5; ++i) {
    commands.push({0.1 * i, {.v = 0.5}});
    twists.push({.pose = {.t = 0.1 * i, .x = 0.0, .y = 0.0, .yaw = 0.0}, .interval = 0.1, .gap = 0.1}, commands);
  }
  CHECK(twists.begins() == 0.0);
}
