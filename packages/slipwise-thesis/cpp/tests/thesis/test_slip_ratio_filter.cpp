// SPDX-License-Identifier: Apache-2.0
// The slip-ratio EKF: recovery, honest covariance, tracking, and refusal of nonsense.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "finite_difference.hpp"
#include "slip_ratio_drive.hpp"
#include "slipwise/thesis/slip_ratio_filter.hpp"

namespace slipwise {
namespace {

const MotionNoise kPoseNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.005, .pose_std_yaw = 0.003};

SlipRatioFilterSettings constant_slip() {
  return {.wheel_separation = tests::kTestTrack, .walk_ratio = 0.0, .walk_angle = 0.0, .noise = kPoseNoise};
}

TEST_CASE("the predicted chart has the derivative that is stated") {
  const auto drive = tests::slip_ratio_drive(1, 3, kPoseNoise);
  const Segment& segment = drive.segments.front();
  const auto chart = [&](const Eigen::VectorXd& slip) -> Eigen::VectorXd {
    const auto at = linearize_slip_ratios(drive.inputs, segment, SlipRatios::from_vector(slip), tests::kTestTrack);
    return at.segment.predicted;
  };
  const auto at = linearize_slip_ratios(drive.inputs, segment, tests::kTestSlip, tests::kTestTrack);
  const auto numeric = tests::finite_difference(chart, tests::kTestSlip.vector(), 0.1);
  CHECK(tests::jacobian_error(at.by_slip_ratios, numeric) < tests::kDerivativeTolerance);
}

TEST_CASE("the filter recovers constant slip ratios within three sigma") {
  SlipRatioFilter filter(constant_slip());
  const auto drive = tests::slip_ratio_drive(150, 7, kPoseNoise);
  for (const Segment& segment : drive.segments) {
    filter.learn(drive.inputs, segment);
  }
  const Eigen::Vector3d error = filter.slip().vector() - tests::kTestSlip.vector();
  for (Eigen::Index i = 0; i < 3; ++i) {
    CAPTURE(i);
    const double sigma = std::sqrt(filter.estimate().covariance(i, i));
    CHECK(std::abs(error[i]) < 3.0 * sigma);
    CHECK(sigma < 0.01);
  }
}

TEST_CASE("innovations are as large as the filter says") {
  double sum = 0.0;
  int count = 0;
  for (const std::uint64_t seed : {11U, 12U, 13U, 14U}) {
    SlipRatioFilter filter(constant_slip());
    const auto drive = tests::slip_ratio_drive(100, seed, kPoseNoise);
    for (const Segment& segment : drive.segments) {
      sum += filter.learn(drive.inputs, segment).nis;
      ++count;
    }
  }
  CHECK(sum / count == doctest::Approx(3.0).epsilon(0.15));
}

TEST_CASE("the random walk lets the filter follow slip that changes") {
  SlipRatioFilterSettings settings = constant_slip();
  settings.walk_ratio = 0.1;
  settings.walk_angle = 0.05;
  SlipRatioFilter following(settings), stiff(constant_slip());
  const InputHistory history = tests::straight_inputs(1.0);
  for (int i = 0; i < 80; ++i) {
    const SlipRatios slip = i < 60 ? SlipRatios{} : SlipRatios{.left = 0.2, .right = 0.2, .angle = -0.1};
    Segment segment{.start = 1.0 + i, .end = 2.0 + i};
    segment.measured.front().z = linearize_slip_ratios(history, segment, slip, tests::kTestTrack).segment.predicted;
    following.learn(history, segment);
    stiff.learn(history, segment);
  }
  CHECK(following.slip().left == doctest::Approx(0.2).epsilon(0.05));
  CHECK(following.slip().angle == doctest::Approx(-0.1).epsilon(0.05));
  CHECK(stiff.slip().left < 0.15);
}

TEST_CASE("turning in place teaches both slip ratios and no slip angle") {
  SlipRatioFilter filter(constant_slip());
  const std::vector<double> t{0.0}, zero{0.0}, turn{0.8};
  const InputHistory history(t, zero, zero, turn);
  for (int i = 0; i < 20; ++i) {
    Segment segment{.start = 1.0 + i, .end = 2.0 + i, .measured = measured_pose({0.0, 0.0, 0.6})};
    filter.learn(history, segment);
  }
  CHECK(filter.slip().left == doctest::Approx(0.25).epsilon(0.05));
  CHECK(filter.slip().right == doctest::Approx(0.25).epsilon(0.05));
  CHECK(std::sqrt(filter.estimate().covariance(2, 2)) > 0.19);
}

TEST_CASE("a pose jump counts for less and leaves the slip possible") {
  SlipRatioFilter filter(constant_slip());
  const InputHistory history = tests::straight_inputs(1.0);
  const auto update = filter.learn(history, {.start = 1.0, .end = 2.0, .measured = measured_pose({-40.0, 25.0, 1.0})});
  CHECK(update.weight < 0.1);
  CHECK(bounded(filter.slip()).vector() == filter.slip().vector());
  CHECK(filter.estimate().covariance.allFinite());
}

TEST_CASE("the linear posterior predicts what the slip ratios predict") {
  SlipRatioFilter filter(constant_slip());
  const auto drive = tests::slip_ratio_drive(5, 9, kPoseNoise);
  for (const Segment& segment : drive.segments) {
    filter.learn(drive.inputs, segment);
  }
  const Estimate linear = filter.linear_estimate();
  CHECK(linear.mean == linear_slip(filter.slip(), tests::kTestTrack).alpha);
  const auto at = linearize_slip_ratios(drive.inputs, drive.segments[0], filter.slip(), tests::kTestTrack);
  const Eigen::Matrix3d there = at.segment.by_parameter * linear.covariance * at.segment.by_parameter.transpose();
  const Eigen::Matrix3d here = at.by_slip_ratios * filter.estimate().covariance * at.by_slip_ratios.transpose();
  CHECK((there - here).norm() < 1e-14);
}

TEST_CASE("senseless settings and segments are refused") {
  CHECK_THROWS_AS(SlipRatioFilter({.wheel_separation = 0.0, .noise = kPoseNoise}), std::invalid_argument);
  CHECK_THROWS_AS(SlipRatioFilter({.walk_ratio = -0.1, .noise = kPoseNoise}), std::invalid_argument);
  CHECK_THROWS_WITH_AS(SlipRatioFilter({}), doctest::Contains("positive wheel separation"), std::invalid_argument);
  SlipRatioFilter filter(constant_slip());
  const InputHistory history = tests::straight_inputs(1.0);
  CHECK_THROWS_AS(filter.learn(history, {.start = 2.0, .end = 1.0}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(filter.learn(history, {.start = 1.0, .end = 2.0, .measured = measured_pose({nan, 0.0, 0.0})}),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
