// SPDX-License-Identifier: Apache-2.0
// Covariances of slip noise and pose noise against seeded Monte-Carlo, and their simple limits.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <random>

#include "sample_bases.hpp"
#include "sample_drives.hpp"
#include "slipwise/linear/symmetric_eigen.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise {
namespace {

SegmentPath sample_path() {
  const Basis basis = named_basis("odd-even-10");
  const InputHistory inputs = tests::sampled(tests::sample_drives()[0].twist, 0.0, 0.05, 200);
  return integrate_segment(MotionModel(basis, {}), tests::sample_slip(basis, 41), inputs, {.start = 1.0, .end = 4.0});
}

Eigen::Matrix3d sample_covariance(int draws, const std::function<Eigen::Vector3d()>& draw) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (int i = 0; i < draws; ++i) {
    const Eigen::Vector3d sample = draw();
    sum += sample;
    squares += sample * sample.transpose();
  }
  return squares / draws - sum * sum.transpose() / draws / draws;
}

/// Eigenvalues of sampled against reported covariance: all one where they agree.
double worst_ratio(const Eigen::Matrix3d& sampled, const Eigen::Matrix3d& stated) {
  const Eigen::Matrix3d root = stated.llt().matrixL(), white = root.inverse();
  return (symmetric_eigen(white * sampled * white.transpose()).values.array() - 1.0).abs().maxCoeff();
}

/// Three standard deviations of a sampled variance, for the worst of three eigenvalues a little more.
double tolerance(int draws) { return 4.0 * std::sqrt(2.0 / draws); }

constexpr int kDraws = 20000;

TEST_CASE("the covariance of white slip noise is that of simulated paths") {
  const SegmentPath path = sample_path();
  const MotionNoise noise{.psd_time = {2e-4, 1e-4, 3e-4}, .psd_motion = {1e-4, 2e-4, 1e-4}};
  std::mt19937_64 random(42);
  std::normal_distribution<double> normal;
  const auto drive_once = [&]() -> Eigen::Vector3d {
    Pose2 pose;
    for (std::size_t k = 0; k < path.tangents.size(); ++k) {
      const ActuatorStep& step = path.drive[k];
      const double wheels = std::abs(step.forward) + kTurnRadius * std::abs(step.turn);
      const double yaw = std::abs(step.turn) + std::abs(step.forward) / kStraightRadius;
      const Eigen::Vector3d motion(wheels, wheels, yaw);
      Eigen::Vector3d tangent = path.tangents[k];
      for (Eigen::Index c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(c);
        tangent[c] += std::sqrt(noise.psd_time[i] * step.duration + noise.psd_motion[i] * motion[c]) * normal(random);
      }
      pose = compose(pose, exp(tangent));
    }
    return pose.vector();
  };
  CHECK(worst_ratio(sample_covariance(kDraws, drive_once), slip_covariance(path, noise)) < tolerance(kDraws));
}

TEST_CASE("the covariance of a slip that lasts the whole segment is that of simulated paths") {
  const SegmentPath path = sample_path();
  const MotionNoise noise{.fraction = {0.01, 0.02, 0.01}};
  std::mt19937_64 random(43);
  std::normal_distribution<double> normal;
  const auto drive_once = [&]() -> Eigen::Vector3d {
    const double lon = normal(random), lat = normal(random), ang = normal(random);
    Pose2 pose;
    for (std::size_t k = 0; k < path.tangents.size(); ++k) {
      const double wheels = std::abs(path.drive[k].forward) + kTurnRadius * std::abs(path.drive[k].turn);
      const double yaw = std::abs(path.drive[k].turn) + std::abs(path.drive[k].forward) / kStraightRadius;
      const Eigen::Vector3d more(0.01 * lon * wheels, 0.02 * lat * wheels, 0.01 * ang * yaw);
      pose = compose(pose, exp(path.tangents[k] + more));
    }
    return pose.vector();
  };
  CHECK(worst_ratio(sample_covariance(kDraws, drive_once), slip_covariance(path, noise)) < tolerance(kDraws));
}

TEST_CASE("the covariance of a lasting slip is made of its columns, one for each channel") {
  SegmentPath path = sample_path();
  path.measured.front().sensor.place = {0.4, -0.1, 0.3};
  const MotionNoise noise{.fraction = {0.05, 0.1, 0.2}};
  const Eigen::Matrix3d columns = constant_slip(path, noise);
  CHECK((columns * columns.transpose() - slip_covariance(path, noise)).norm() < 1e-14);
}

TEST_CASE("the covariance of pose noise is that of two noisy poses observed from the first") {
  const MotionNoise noise{.pose_std_xy = 0.02, .pose_std_yaw = 0.01};
  const Pose2 start{3.0, -1.0, 0.7};
  for (const Pose2& motion : {Pose2{2.0, 0.5, 0.4}, Pose2{-0.5, 3.0, -1.5}, Pose2{0.0, 0.0, 7.0}}) {
    CAPTURE(motion.theta);
    std::mt19937_64 random(44);
    std::normal_distribution<double> normal;
    const auto disturbed = [&](const Pose2& pose) {
      const double x = normal(random), y = normal(random), yaw = normal(random);
      return Pose2{pose.x + 0.02 * x, pose.y + 0.02 * y, pose.theta + 0.01 * yaw};
    };
    const auto measure_once = [&]() -> Eigen::Vector3d {
      const Pose2 first = disturbed(start);
      return between(first, disturbed(compose(start, motion))).vector();
    };
    CHECK(worst_ratio(sample_covariance(kDraws, measure_once), pose_noise_covariance(motion, noise)) <
          tolerance(kDraws));
  }
}

TEST_CASE("a pose that is said to be less exact than others has larger noise") {
  const MotionNoise noise{.pose_std_xy = 0.02, .pose_std_yaw = 0.01};
  const MotionNoise other{.pose_std_xy = 0.5, .pose_std_yaw = 0.2};
  const PoseStdRatio poor{.xy = 25.0, .yaw = 20.0};
  const Pose2 motion{1.0, -0.6, -1.1};
  const Eigen::Matrix3d without = pose_noise_covariance(motion, noise);
  CHECK(pose_noise_covariance(motion, noise, {poor, poor}).isApprox(pose_noise_covariance(motion, other)));
  CHECK(pose_noise_covariance(motion, noise, {PoseStdRatio{}, poor})(0, 0) ==
        doctest::Approx(without(0, 0) + 0.5 * 0.5 - 0.02 * 0.02));
  CHECK(shared_pose_noise(motion, motion, noise, poor).isApprox(shared_pose_noise(motion, motion, other)));
}

TEST_CASE("motions that meet at a measured pose share its noise") {
  const MotionNoise noise{.pose_std_xy = 0.02, .pose_std_yaw = 0.01};
  const Pose2 start{3.0, -1.0, 0.7}, before{2.0, 0.5, 0.4}, after{1.0, -0.6, -1.1};
  std::mt19937_64 random(45);
  std::normal_distribution<double> normal;
  const auto disturbed = [&](const Pose2& pose) {
    const double x = normal(random), y = normal(random), yaw = normal(random);
    return Pose2{pose.x + 0.02 * x, pose.y + 0.02 * y, pose.theta + 0.01 * yaw};
  };
  const Pose2 meeting = compose(start, before);
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Pose2 met = disturbed(meeting);
    const Eigen::Vector3d first = between(disturbed(start), met).vector() - before.vector();
    const Eigen::Vector3d second = between(met, disturbed(compose(meeting, after))).vector() - after.vector();
    sampled += second * first.transpose() / kDraws;
  }
  const Eigen::Vector3d of_first = pose_noise_covariance(before, noise).diagonal();
  const Eigen::Vector3d of_second = pose_noise_covariance(after, noise).diagonal();
  const Eigen::Matrix3d off = (sampled - shared_pose_noise(after, before, noise)).cwiseAbs();
  const Eigen::Matrix3d nominal = (of_second * of_first.transpose() / kDraws).cwiseSqrt();
  CHECK(off.cwiseQuotient(nominal).maxCoeff() < 5.0);
  CHECK(sampled.cwiseAbs().cwiseQuotient(nominal).maxCoeff() > 20.0);
}

TEST_CASE("a parked robot gathers no slip noise") {
  const InputHistory inputs = tests::sampled([](double) { return BodyTwist{}; }, 0.0, 0.05, 100);
  const SegmentPath path = integrate_segment(MotionModel(named_basis("edd-2"), {}), Eigen::Vector2d::Zero(), inputs,
                                             {.start = 1.0, .end = 4.0});
  const MotionNoise noise{.psd_time = {1.0, 1.0, 1.0}, .psd_motion = {1.0, 1.0, 1.0}, .fraction = {1.0, 1.0, 1.0}};
  CHECK(slip_covariance(path, noise).isZero(0.0));
}

TEST_CASE("white slip noise does not depend on how finely the drive is sampled") {
  const MotionNoise noise{.psd_time = {2e-3, 1e-3, 3e-3}, .psd_motion = {1e-3, 2e-3, 1e-3}};
  const auto covariance = [&](double period) {
    const InputHistory inputs = tests::sampled([](double) { return BodyTwist{1.0, 0.0, 0.4}; }, 0.0, period,
                                               static_cast<std::size_t>(6.0 / period));
    const SegmentPath path = integrate_segment(MotionModel(named_basis("edd-2"), {}), Eigen::Vector2d::Zero(), inputs,
                                               {.start = 1.0, .end = 4.0});
    return slip_covariance(path, noise);
  };
  CHECK((covariance(0.05) - covariance(0.01)).norm() / covariance(0.01).norm() < 1e-3);
}

TEST_CASE("on a straight line, slip noise grows as time and yaw noise swings the end sideways") {
  const InputHistory inputs = tests::sampled([](double) { return BodyTwist{2.0, 0.0, 0.0}; }, 0.0, 0.01, 1000);
  const SegmentPath path = integrate_segment(MotionModel(named_basis("edd-2"), {}), Eigen::Vector2d::Zero(), inputs,
                                             {.start = 1.0, .end = 4.0});
  const Eigen::Matrix3d covariance = slip_covariance(path, {.psd_time = {0.1, 0.0, 0.2}});
  CHECK(covariance(0, 0) == doctest::Approx(0.1 * 3.0).epsilon(1e-9));
  CHECK(covariance(2, 2) == doctest::Approx(0.2 * 3.0).epsilon(1e-9));
  CHECK(covariance(1, 1) == doctest::Approx(0.2 * 4.0 * 27.0 / 3.0).epsilon(1e-4));  // q v^2 T^3 / 3
  CHECK(covariance(1, 2) == doctest::Approx(0.2 * 2.0 * 9.0 / 2.0).epsilon(1e-4));   // q v T^2 / 2
}

}  // namespace
}  // namespace slipwise
