// SPDX-License-Identifier: Apache-2.0
// The laws of the group SE(2), and its exponential against the exponential of a matrix.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "slipwise/lie/se2.hpp"

namespace slipwise {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

double distance(const Pose2& a, const Pose2& b) { return (a.vector() - b.vector()).lpNorm<Eigen::Infinity>(); }

/// Random poses and poses near the singularity of log on purpose.
std::vector<Pose2> sample_poses() {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  std::vector<Pose2> poses{{}, {1.0, -2.0, 0.0}, {0.5, 0.5, 1e-9}, {-1.0, 0.3, -0.03}, {0.2, 0.1, kHalfTurn - 1e-9}};
  for (int i = 0; i < 20; ++i) {
    const double x = uniform(random), y = uniform(random);
    poses.push_back({x, y, uniform(random)});
  }
  return poses;
}

/// Plain oracle: Taylor series of the matrix exponential with scaling and squaring.
Eigen::Matrix3d matrix_exponential(const Eigen::Vector3d& tangent) {
  Eigen::Matrix3d generator = Eigen::Matrix3d::Zero();
  generator << 0.0, -tangent.z(), tangent.x(), tangent.z(), 0.0, tangent.y(), 0.0, 0.0, 0.0;
  constexpr int kSquarings = 6;
  generator /= std::exp2(kSquarings);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), power = Eigen::Matrix3d::Identity();
  for (int n = 1; n <= 18; ++n) {
    power = power * generator / n;
    sum += power;
  }
  for (int i = 0; i < kSquarings; ++i) {
    sum = (sum * sum).eval();
  }
  return sum;
}

Eigen::Matrix3d homogeneous(const Pose2& pose) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.topLeftCorner<2, 2>() = rotation(pose.theta);
  matrix.topRightCorner<2, 1>() << pose.x, pose.y;
  return matrix;
}

TEST_CASE("a pose and its inverse cancel") {
  for (const Pose2& pose : sample_poses()) {
    CHECK(distance(compose(pose, inverse(pose)), {}) < 1e-14);
    CHECK(distance(compose(inverse(pose), pose), {}) < 1e-14);
  }
}

TEST_CASE("composition is the product of homogeneous matrices") {
  const auto poses = sample_poses();
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Eigen::Matrix3d product = homogeneous(poses[i]) * homogeneous(poses[i + 1]);
    CHECK((homogeneous(compose(poses[i], poses[i + 1])) - product).norm() < 1e-13);
  }
}

TEST_CASE("between undoes composition") {
  const auto poses = sample_poses();
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    CHECK(distance(between(poses[i], compose(poses[i], poses[i + 1])), poses[i + 1]) < 1e-13);
  }
}

TEST_CASE("exp and log undo each other within half a turn") {
  for (const Pose2& pose : sample_poses()) {
    CAPTURE(pose.theta);
    CHECK(distance(exp(log(pose)), pose) < 1e-13);
    CHECK((log(exp(pose.vector())) - pose.vector()).norm() < 1e-13);
  }
}

TEST_CASE("exp is the matrix exponential") {
  for (const Pose2& pose : sample_poses()) {
    const Eigen::Vector3d tangent = 2.0 * pose.vector();
    CHECK((homogeneous(exp(tangent)) - matrix_exponential(tangent)).lpNorm<Eigen::Infinity>() < 1e-12);
  }
}

TEST_CASE("exp counts whole turns and returns to the start of the circle") {
  const Pose2 pose = exp({2.0, 0.0, 4.0 * kHalfTurn});
  CHECK(pose.theta == 4.0 * kHalfTurn);
  CHECK(std::hypot(pose.x, pose.y) < 1e-14);
}

TEST_CASE("log of more than half a turn goes the short way to the same place") {
  const Pose2 pose{1.0, 2.0, 4.0};
  const Pose2 reached = exp(log(pose));
  CHECK(reached.theta == doctest::Approx(4.0 - 2.0 * kHalfTurn).epsilon(1e-14));
  CHECK(std::hypot(reached.x - pose.x, reached.y - pose.y) < 1e-13);
}

TEST_CASE("the adjoint carries a tangent through a pose") {
  const Eigen::Vector3d tangent(0.3, -0.2, 0.5);
  for (const Pose2& pose : sample_poses()) {
    const Pose2 left = compose(exp(adjoint(pose) * tangent), pose);
    CHECK(distance(left, compose(pose, exp(tangent))) < 1e-13);
  }
}

}  // namespace
}  // namespace slipwise
