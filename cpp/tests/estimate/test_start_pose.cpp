// SPDX-License-Identifier: Apache-2.0
// Where a prediction starts: noise of poses averaged out where there is some, and left alone where there is none.
#include "slipwise/estimate/start_pose.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "simulated_drive.hpp"
#include "slipwise/estimate/causal_filter.hpp"

namespace slipwise {
namespace {

constexpr double kPeriod = 0.05;  // of the poses [s]

struct Setting {
  std::mt19937_64 random{5};
  MotionModel model{named_basis("edd-2"), {}};
  InputTrack inputs = tests::random_inputs(random, 620.0, 0.05);
  MotionPosterior belief{.model = model,
                         .estimate = {Eigen::Vector2d(-0.1, -0.3), Eigen::Matrix2d::Zero()},
                         .prior_std = Eigen::Vector2d(0.3, 0.3),
                         .noise = {.pose_std_xy = 0.02, .pose_std_yaw = 0.01},
                         .noise_scale = Eigen::Vector3d::Ones()};
};

enum class Noise : std::uint8_t { None, White };

/// Poses every 0.05 s from a start at 1 s, and where the sensor truly was.
struct Drive {
  std::vector<Pose2> truth;
  std::vector<Pose2> poses;
};

Drive drive(Setting& s, int count, Noise noise) {
  Drive drive;
  Pose2 pose{3.0, -2.0, 1.0};
  for (int i = 0; i < count; ++i) {
    drive.truth.push_back(pose);
    const Eigen::Vector3d missed = tests::normal3(s.random).cwiseProduct(Eigen::Vector3d(0.02, 0.02, 0.01));
    drive.poses.push_back(noise == Noise::None ? pose : Pose2::from_vector(pose.vector() + missed));
    const Segment step{.start = 1.0 + kPeriod * i, .end = 1.0 + kPeriod * (i + 1)};
    pose = compose(pose, integrate_segment(s.model, s.belief.estimate.mean, s.inputs, step).poses.back());
  }
  return drive;
}

SeenPoses seen_until(const Drive& drive, int last, int count) {
  SeenPoses seen;
  for (int i = std::max(0, last - count + 1); i <= last; ++i) {
    seen.stamps.push_back(1.0 + kPeriod * i);
    seen.poses.push_back(drive.poses[static_cast<std::size_t>(i)]);
  }
  return seen;
}

Segment window(const Drive& drive, int first, int last) {
  const auto at = [&](int i) { return drive.poses[static_cast<std::size_t>(i)]; };
  return {.start = 1.0 + kPeriod * first, .end = 1.0 + kPeriod * last, .measured = between(at(first), at(last))};
}

ExpectedPose expected(const Setting& s, const Segment& segment) {
  const auto at = linearize_segment(s.model, s.belief.estimate.mean, s.inputs, segment);
  return {at.predicted.vector(),
          prediction_covariance(at, s.belief.estimate.covariance, s.belief.noise, s.belief.noise_scale)};
}

struct Learned {
  StartPose start{StartPoseSettings{}};
  double error = 0.0;           ///< mean squared distance of the start from the truth, second half
  double measured_error = 0.0;  ///< of the measured start
};

Learned learn(Setting& s, Noise noise) {
  Learned learned;
  const Drive driven = drive(s, 12000, noise);
  for (int first = 40; first + 20 < 12000; first += 20) {
    const Segment segment = window(driven, first, first + 20);
    const SeenPoses seen = seen_until(driven, first, 33);
    if (first > 6000) {
      const Pose2& truth = driven.truth[static_cast<std::size_t>(first)];
      const Pose2& measured = driven.poses[static_cast<std::size_t>(first)];
      const Pose2 start = compose(measured, learned.start.offset(s.belief, s.inputs, seen, segment));
      learned.error += (start.vector() - truth.vector()).head<2>().squaredNorm();
      learned.measured_error += (measured.vector() - truth.vector()).head<2>().squaredNorm();
    }
    learned.start.learn(s.belief, s.inputs, seen, segment, expected(s, segment));
  }
  return learned;
}

TEST_CASE("white noise of poses is averaged out of the start") {
  Setting s;
  const Learned learned = learn(s, Noise::White);
  CHECK(learned.start.law().weights[0] < 0.01);
  CHECK(learned.error < 0.25 * learned.measured_error);
}

TEST_CASE("poses without noise are all where the model carries them, and the start stays as measured") {
  Setting s;
  const Learned learned = learn(s, Noise::None);
  CHECK(learned.start.law().weights[0] > 0.8);
  CHECK(learned.error < 1e-20);
}

TEST_CASE("a model that is wrong does not pull the start away from poses that are right") {
  Setting s;
  const Drive driven = drive(s, 4000, Noise::None);
  s.belief.estimate.mean = Eigen::Vector2d(0.05, -0.1);
  StartPose start{StartPoseSettings{}};
  for (int first = 40; first + 20 < 4000; first += 20) {
    const Segment segment = window(driven, first, first + 20);
    start.learn(s.belief, s.inputs, seen_until(driven, first, 33), segment, expected(s, segment));
  }
  CHECK(start.law().weights[0] > 0.9);
}

TEST_CASE("a known memory is the mean that it says, where the sensor sits and whatever the frame") {
  Setting s;
  Drive driven = drive(s, 60, Noise::White);
  const StartPose start(StartLaw{{0.2}, Eigen::VectorXd::Ones(1)});
  const Segment segment = window(driven, 40, 59);
  const Pose2 offset = start.offset(s.belief, s.inputs, seen_until(driven, 40, 3), segment);
  double sum = 0.0;
  double turn = 0.0;
  for (int i = 38; i <= 40; ++i) {
    const double weight = std::exp(-kPeriod * (40 - i) / 0.2);
    const Pose2 missed = Pose2::from_vector(driven.poses[static_cast<std::size_t>(i)].vector() -
                                            driven.truth[static_cast<std::size_t>(i)].vector());
    const Pose2 missed_last = Pose2::from_vector(driven.poses[40].vector() - driven.truth[40].vector());
    sum += weight;
    turn += weight * (missed.theta - missed_last.theta);
  }
  CHECK(offset.theta == doctest::Approx(turn / sum).epsilon(1e-9));

  const Pose2 other_frame{-7.0, 4.0, 2.5};
  for (Pose2& pose : driven.poses) {
    pose = compose(other_frame, pose);
  }
  const Pose2 same = start.offset(s.belief, s.inputs, seen_until(driven, 40, 3), segment);
  CHECK((same.vector() - offset.vector()).norm() < 1e-12);
}

TEST_CASE("a sensor beside the robot's middle is carried on its own path") {
  Setting s;
  Drive driven = drive(s, 60, Noise::None);
  const Pose2 sensor{0.4, -0.2, 0.7};
  for (Pose2& pose : driven.poses) {
    pose = compose(pose, sensor);
  }
  Segment segment = window(driven, 40, 59);
  segment.sensor = sensor;
  const StartPose start(StartLaw{{0.4}, Eigen::VectorXd::Ones(1)});
  const Pose2 offset = start.offset(s.belief, s.inputs, seen_until(driven, 40, 30), segment);
  CHECK(offset.vector().norm() < 1e-12);
}

TEST_CASE("an end moves with its start, and its covariance turns") {
  const ExpectedPose expected{{2.0, 1.0, 0.3}, Eigen::Vector3d(0.04, 0.01, 0.02).asDiagonal()};
  const ExpectedPose moved = starting_at({0.1, -0.2, std::acos(0.0)}, expected);
  CHECK((moved.pose - Eigen::Vector3d(-0.9, 1.8, 0.3 + std::acos(0.0))).norm() < 1e-12);
  CHECK((moved.covariance.diagonal() - Eigen::Vector3d(0.01, 0.04, 0.02)).norm() < 1e-12);
}

TEST_CASE("one pose, or none, says nothing more than the start itself") {
  Setting s;
  const Drive driven = drive(s, 60, Noise::White);
  const Segment segment = window(driven, 40, 59);
  StartPose start{StartPoseSettings{}};
  CHECK(start.offset(s.belief, s.inputs, {}, segment).vector() == Eigen::Vector3d::Zero());
  CHECK(start.offset(s.belief, s.inputs, seen_until(driven, 40, 1), segment).vector() == Eigen::Vector3d::Zero());
  start.learn(s.belief, s.inputs, seen_until(driven, 40, 1), segment, expected(s, segment));
  CHECK(start.law().weights[0] == StartPoseSettings{}.measured);
}

TEST_CASE("stamps that do not lead to the start, and numbers that are no memories, are refused") {
  Setting s;
  const Drive driven = drive(s, 60, Noise::White);
  const Segment segment = window(driven, 40, 59);
  const StartPose start{StartPoseSettings{}};
  CHECK_THROWS_AS(start.offset(s.belief, s.inputs, seen_until(driven, 39, 5), segment), std::invalid_argument);
  SeenPoses twice = seen_until(driven, 40, 5);
  twice.stamps[2] = twice.stamps[1];
  CHECK_THROWS_AS(start.offset(s.belief, s.inputs, twice, segment), std::invalid_argument);
  SeenPoses fewer = seen_until(driven, 40, 5);
  fewer.poses.pop_back();
  CHECK_THROWS_AS(start.offset(s.belief, s.inputs, fewer, segment), std::invalid_argument);
  CHECK_THROWS_AS(StartPose(StartPoseSettings{.memories = {0.1, 0.0}}), std::invalid_argument);
  CHECK_THROWS_AS(StartPose(StartPoseSettings{.memories = {std::numeric_limits<double>::infinity()}}),
                  std::invalid_argument);
  CHECK_THROWS_AS(StartPose(StartLaw{{0.1}, Eigen::VectorXd::Constant(1, 0.5)}), std::invalid_argument);
  CHECK_THROWS_AS(StartPose(StartLaw{{-0.1}, Eigen::VectorXd::Ones(1)}), std::invalid_argument);
  CHECK_THROWS_AS(StartPose(StartLaw{{0.1}, Eigen::VectorXd::Ones(2)}), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
