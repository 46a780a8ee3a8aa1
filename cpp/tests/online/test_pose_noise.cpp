// SPDX-License-Identifier: Apache-2.0
// The scatter of poses is found beside any motion noise, and what lasts is not taken for it.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "slipwise/online/pose_noise.hpp"

namespace slipwise {
namespace {

/// Errors of the motion between poses of the given scatter, each with a motion error of its own.
PoseNoise learned(double pose_std, double motion_std, double constant, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  PoseNoise noise({.xy = 0.02, .yaw = 0.01});
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d now = pose_std * Eigen::Vector3d(normal(random), normal(random), normal(random));
    const Eigen::Vector3d motion = motion_std * Eigen::Vector3d(normal(random), normal(random), normal(random));
    noise.learn(now - before + motion + Eigen::Vector3d::Constant(constant), {});
    before = now;
  }
  return noise;
}

TEST_CASE("the scatter of poses is learned, with or without motion noise and a constant error beside it") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    CAPTURE(seed);
    for (const double motion : {0.0, 0.05}) {
      const Eigen::Vector3d found = learned(0.05, motion, 0.02, seed).variances({}).cwiseSqrt();
      CHECK(found.x() == doctest::Approx(0.05).epsilon(0.25));
      CHECK(found.z() == doctest::Approx(0.05).epsilon(0.25));
    }
  }
}

TEST_CASE("motion noise alone is not taken for the scatter of poses") {
  const Eigen::Vector3d found = learned(0.0, 0.05, 0.0, 4).variances({}).cwiseSqrt();
  CHECK(found.x() < 0.025);
}

TEST_CASE("it begins with what is stated, and a pose counts by its ratio") {
  const PoseNoise noise({.xy = 0.1, .yaw = 0.2});
  const Eigen::Vector3d found = noise.variances({.xy = 2.0, .yaw = 3.0});
  CHECK(found.x() == doctest::Approx(0.04));
  CHECK(found.y() == doctest::Approx(0.04));
  CHECK(found.z() == doctest::Approx(0.36));
}

TEST_CASE("errors that do not follow each other teach nothing") {
  PoseNoise noise({.xy = 0.1, .yaw = 0.2});
  for (int i = 0; i < 10; ++i) {
    noise.learn(Eigen::Vector3d(i % 2 == 0 ? 1.0 : -1.0, 0.0, 0.0), {});
    noise.pause();
  }
  CHECK(noise.variances({}).x() == doctest::Approx(0.01));
}

}  // namespace
}  // namespace slipwise
