// SPDX-License-Identifier: Apache-2.0
// The sliding-mode observer: it reaches known slip in a stated time, does not chatter, and stays bounded under noise.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "slip_ratio_drive.hpp"
#include "slipwise/thesis/sliding_mode_observer.hpp"

namespace slipwise {
namespace {

const SlidingModeSettings kSettings{.wheel_separation = tests::kTestTrack};

Segment exact_segment(const InputHistory& history, double start, const SlipRatios& slip) {
  Segment segment{.start = start, .end = start + 1.0};
  segment.measured.front().z = linearize_slip_ratios(history, segment, slip, tests::kTestTrack).segment.predicted;
  return segment;
}

double largest_error(const SlidingModeObserver& observer) {
  return (observer.slip().vector() - tests::kTestSlip.vector()).cwiseAbs().maxCoeff();
}

TEST_CASE("known slip is reached within twenty seconds of driving at 0.4 m/s and more") {
  SlidingModeObserver observer(kSettings);
  const auto drive = tests::slip_ratio_drive(60, 5, {});
  std::size_t seconds = 0;
  for (const Segment& segment : drive.segments) {
    observer.learn(drive.inputs, segment);
    if (++seconds > 20) {
      CHECK(largest_error(observer) < 0.01);
    }
  }
  CHECK(largest_error(observer) < 1e-3);
}

TEST_CASE("outside its boundary layer a slip moves at the full gain and no faster") {
  SlidingModeObserver observer({.wheel_separation = tests::kTestTrack, .ratio_gain = 0.02});
  const InputHistory history = tests::straight_inputs(1.0);
  const SlipRatios slip{.left = 0.5, .right = -0.5};
  for (int i = 1; i <= 10; ++i) {
    observer.learn(history, exact_segment(history, i, slip));
    CHECK(observer.slip().left == doctest::Approx(0.02 * i));
    CHECK(observer.slip().right == doctest::Approx(-0.02 * i));
  }
}

TEST_CASE("at its goal the observer comes to rest without chatter, at any speed") {
  for (const double v : {0.1, 1.0, 20.0, -3.0}) {
    CAPTURE(v);
    SlidingModeObserver observer(kSettings);
    const InputHistory history = tests::straight_inputs(v);
    double before = tests::kTestSlip.left;
    for (int i = 1; i <= 200; ++i) {
      observer.learn(history, exact_segment(history, i, {.left = 0.18, .right = 0.18, .angle = 0.1}));
      const double left = 0.18 - observer.slip().left;
      CHECK(left >= -1e-12);  // it never overshoots
      CHECK(left <= before + 1e-12);
      before = left;
    }
    CHECK(before < 1e-3);
  }
}

TEST_CASE("under noise the error stays bounded") {
  const MotionNoise noise{.psd_time = {1e-3, 1e-3, 1e-3}, .pose_std_xy = 0.02, .pose_std_yaw = 0.01};
  SlidingModeObserver observer(kSettings);
  const auto drive = tests::slip_ratio_drive(400, 8, noise);
  double worst = 0.0, sum = 0.0;
  std::size_t count = 0;
  for (const Segment& segment : drive.segments) {
    observer.learn(drive.inputs, segment);
    if (++count > 30) {
      worst = std::max(worst, largest_error(observer));
      sum += largest_error(observer);
    }
  }
  CHECK(worst < 0.15);
  CHECK(sum / static_cast<double>(count - 30) < 0.04);
}

TEST_CASE("a parked side and a turn in place teach nothing about the slip that they do not show") {
  SlidingModeObserver observer(kSettings);
  const double c = tests::kTestTrack / 2.0;
  const std::vector<double> t{0.0}, v{0.4}, zero{0.0}, pivot{0.4 / c}, turn{1.0};
  const InputHistory one_side(t, v, zero, pivot), in_place(t, zero, zero, turn);
  observer.learn(one_side, {.start = 1.0, .end = 2.0, .measured = measured_pose({0.2, 0.1, 0.5})});
  CHECK(observer.slip().left == 0.0);
  CHECK(observer.slip().right != 0.0);
  SlidingModeObserver other(kSettings);
  other.learn(in_place, {.start = 1.0, .end = 2.0, .measured = measured_pose({0.0, 0.3, 0.7})});
  CHECK(other.slip().angle == 0.0);
}

TEST_CASE("a segment of nearly half a turn is left out, and says so") {
  SlidingModeObserver observer(kSettings);
  const InputHistory history = tests::straight_inputs(1.0);
  const auto update = observer.learn(history, {.start = 1.0, .end = 2.0, .measured = measured_pose({0.1, 0.1, 3.1})});
  CHECK_FALSE(update.used);
  CHECK(observer.slip().vector() == Eigen::Vector3d::Zero());
}

TEST_CASE("senseless settings and segments are refused") {
  CHECK_THROWS_AS(SlidingModeObserver({.ratio_gain = 0.0}), std::invalid_argument);
  CHECK_THROWS_WITH_AS(SlidingModeObserver({.wheel_separation = -1.0}), doctest::Contains("must be positive"),
                       std::invalid_argument);
  SlidingModeObserver observer(kSettings);
  const InputHistory history = tests::straight_inputs(1.0);
  CHECK_THROWS_AS(observer.learn(history, {.start = 2.0, .end = 2.0}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
