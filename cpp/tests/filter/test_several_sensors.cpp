// SPDX-License-Identifier: Apache-2.0
// Several sensors of one segment: the filters learn from all of them as from one after the other.
#include <doctest/doctest.h>

#include <random>

#include "simulated_drive.hpp"
#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/iekf.hpp"

namespace slipwise {
namespace {

const MotionNoise kPoses{.pose_std_xy = 0.01, .pose_std_yaw = 0.05};
constexpr double kGyroStd = 1e-3;  // [rad]
const std::vector<std::string> kSpeed{"V"}, kYaw{"w"};

Measured by_gyro(double turn) {
  return {.sensor = {.kind = YawRateSensor{RowsCovariance::Constant(1, 1, kGyroStd * kGyroStd)}},
          .z = Rows::Constant(1, turn)};
}

Estimate learned(const MotionModel& model, const Estimate& prior, const InputHistory& inputs, const Segment& segment) {
  const SegmentPath path = integrate_segment(model, prior.mean, inputs, segment);
  const RowsCovariance noise = segment_noise(path, rows_of(segment.measured), kPoses, Eigen::Vector3d::Ones());
  return iekf_update(model, prior, inputs, segment, noise, {.huber = 1e6, .gate = 1e6}).estimate;
}

}  // namespace

TEST_CASE("a pose and a gyro in one segment teach what they do one after the other") {
  const MotionModel model(Basis("scale", kSpeed, {}, kYaw), {});
  const InputHistory inputs({0.0}, {BodyTwist{.v = 1.0, .vy = 0.0, .omega = 0.3}});
  const Estimate prior{Eigen::Vector2d::Zero(), 1e-4 * Eigen::Matrix2d::Identity()};
  Segment pose{.start = 1.0, .end = 3.0, .measured = measured_pose({1.86, 0.56, 0.61})};
  Segment turn{.start = 1.0, .end = 3.0, .measured = {by_gyro(0.597)}};
  Segment both = pose;
  both.measured.push_back(turn.measured.front());
  const Estimate once = learned(model, prior, inputs, both);
  const Estimate apart = learned(model, learned(model, prior, inputs, pose), inputs, turn);
  CHECK((once.mean - apart.mean).norm() < 1e-4 * prior.covariance.diagonal().cwiseSqrt().norm());
  CHECK(once.covariance.isApprox(apart.covariance, 1e-3));
  CHECK(once.covariance(1, 1) < 0.1 * learned(model, prior, inputs, pose).covariance(1, 1));
}

TEST_CASE("a filter takes segments of whatever sensors as they come, and learns the noise of what each measures") {
  const MotionModel model(Basis("scale", kSpeed, {}, kYaw), {});
  const Eigen::Vector2d truth(-0.05, -0.12);
  const auto drive = tests::simulate_drive(model, truth, {.seed = 7, .windows = 120, .window = 2.0, .noise = kPoses});
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  CausalFilter filter(model, {.noise = {.shape = kPoses}});
  for (std::size_t i = 0; i < drive.segments.size(); ++i) {
    Segment segment = drive.segments[i];
    const double turned = integrate_segment(model, truth, drive.inputs, segment).poses.back().theta;
    if (i % 3 == 1) {
      segment.measured.clear();
    }
    if (i % 3 > 0) {
      segment.measured.push_back(by_gyro(turned + kGyroStd * normal(random)));
    }
    filter.learn(drive.inputs, segment, {.v = 1.0, .omega = 1.0});
  }
  const Estimate found = filter.reported();
  for (Eigen::Index i = 0; i < 2; ++i) {
    CHECK(std::abs(found.mean[i] - truth[i]) < 3.5 * std::sqrt(found.covariance(i, i)));
  }
  CHECK(std::sqrt(found.covariance(1, 1)) < 1e-3);
  CHECK(filter.noise_scale().head<2>().maxCoeff() < 1.6);
  CHECK(filter.noise_scale().minCoeff() > 0.5);
}

TEST_CASE("more rows than a segment can hold, and a noise of other rows, are refused") {
  const MotionModel model(Basis("scale", kSpeed, {}, kYaw), {});
  const InputHistory inputs({0.0}, {BodyTwist{.v = 1.0}});
  const Estimate prior{Eigen::Vector2d::Zero(), 1e-4 * Eigen::Matrix2d::Identity()};
  Segment segment{.start = 1.0, .end = 3.0};
  segment.measured.push_back(by_gyro(0.0));
  CHECK_THROWS_AS(iekf_update(model, prior, inputs, segment, Eigen::Matrix3d::Identity()), std::invalid_argument);
  segment.measured.insert(segment.measured.end(), 2, Measured{});
  CHECK_THROWS_AS(linearize_segment(model, prior.mean, inputs, segment), std::invalid_argument);
}

}  // namespace slipwise
