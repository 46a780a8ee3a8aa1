// SPDX-License-Identifier: Apache-2.0
// What all positions of a stretch tell of its motion: exact without noise, as noisy as stated with it, nothing at rest.
#include "slipwise/online/position_fit.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "slipwise/lie/angle.hpp"
#include "slipwise/sensor/sensor_motion.hpp"

namespace slipwise {
namespace {

constexpr double kSeconds = 5.0;
constexpr int kPositions = 50;

BodyTwist driven(double t) { return {.v = 0.8 + 0.3 * std::sin(t), .vy = 0.0, .omega = t < 2.0 ? 0.5 : -0.4}; }

InputBuffer inputs_of(double scale) {
  InputBuffer inputs(0.5);
  for (int i = 0; i < 110; ++i) {
    const BodyTwist twist = driven(0.05 * i);
    inputs.push({0.05 * i, {.v = scale * twist.v, .vy = 0.0, .omega = scale * twist.omega}});
  }
  return inputs;
}

/// A robot that slips by fractions of its speed and of its yaw rate, from some pose on.
struct Drive {
  Pose2 from = {7.0, -3.0, 2.1};
  Pose2 antenna = {0.3, 0.1, 0.0};
  double forward = -0.1;
  double turning = -0.3;
  double noise = 0.0;
  std::mt19937_64 random{7};

  Pose2 robot(double until) const {
    Pose2 pose;
    for (int i = 0; 0.05 * i < until - 1e-9; ++i) {
      const BodyTwist twist = driven(0.05 * i);
      const double seconds = std::min(0.05, until - 0.05 * i);
      const Eigen::Vector3d slipping(twist.v * (1.0 + forward), 0.0, twist.omega * (1.0 + turning));
      pose = compose(pose, exp(slipping * seconds));
    }
    return pose;
  }
  std::vector<MeasuredPose> positions() {
    std::normal_distribution<double> normal;
    std::vector<MeasuredPose> found;
    for (int i = 0; i < kPositions; ++i) {
      const double t = kSeconds * i / kPositions;
      const Pose2 at = compose(compose(from, robot(t)), antenna);
      found.push_back({.t = t,
                       .x = at.x + noise * normal(random),
                       .y = at.y + noise * normal(random),
                       .yaw = 0.0,
                       .position = true});
    }
    return found;
  }
  Eigen::Vector3d motion() const { return sensor_motion(robot(kSeconds), antenna).vector(); }
};

}  // namespace

TEST_CASE("positions without noise tell the motion of the antenna and where the robot headed, however it slips") {
  Drive drive;
  const auto found = fit_positions(drive.positions(), kSeconds, inputs_of(1.0), drive.antenna);
  REQUIRE(found);
  CHECK((found->z - drive.motion()).norm() < 0.01);
  CHECK(std::abs(wrap_angle(found->heading - drive.from.theta)) < 0.01);
  CHECK(found->sensor.at.size() == static_cast<Eigen::Index>(kMostMoments));
  CHECK(found->sensor.weights.maxCoeff() == doctest::Approx(found->sensor.weights.minCoeff()));
}

TEST_CASE("the motion of noisy positions scatters as stated, without a bias") {
  Drive drive{.noise = 0.05};
  const InputBuffer inputs = inputs_of(1.0);
  const MotionNoise noise{.pose_std_xy = 0.01, .pose_std_yaw = 1e-3};
  constexpr int kDraws = 400;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const auto found = fit_positions(drive.positions(), kSeconds, inputs, drive.antenna);
    REQUIRE(found);
    const Eigen::Matrix3d stated = found->sensor.noise({}, noise);
    const Eigen::Vector3d off = (found->z - drive.motion()).cwiseQuotient(stated.diagonal().cwiseSqrt());
    sum += off;
    squares += off.cwiseAbs2();
  }
  CHECK((sum / kDraws).cwiseAbs().maxCoeff() < 0.2);
  CHECK((squares / kDraws).cwiseSqrt().maxCoeff() < 1.15);
  CHECK((squares / kDraws).cwiseSqrt().minCoeff() > 0.85);
}

TEST_CASE("what stands, spins its wheels, or was measured twice alone tells no course") {
  Drive drive;
  const InputBuffer inputs = inputs_of(1.0);
  std::vector<MeasuredPose> positions = drive.positions();
  CHECK_FALSE(fit_positions({positions[0], positions[20]}, kSeconds, inputs, drive.antenna));
  CHECK_FALSE(fit_positions(positions, 9.0, inputs, drive.antenna));  // inputs end before
  CHECK_FALSE(fit_positions(positions, kSeconds, inputs_of(0.0), drive.antenna));
  for (MeasuredPose& each : positions) {
    each.x = each.y = 0.0;
  }
  CHECK_FALSE(fit_positions(positions, kSeconds, inputs, drive.antenna));
}

TEST_CASE("positions that are said to be poor count less") {
  Drive drive;
  std::vector<MeasuredPose> positions = drive.positions();
  for (std::size_t i = 0; i < positions.size(); i += 2) {
    positions[i].x += 0.5;
    positions[i].std_ratio.xy = 1e3;
  }
  const auto found = fit_positions(positions, kSeconds, inputs_of(1.0), drive.antenna);
  REQUIRE(found);
  CHECK((found->z - drive.motion()).norm() < 0.01);
}

}  // namespace slipwise
