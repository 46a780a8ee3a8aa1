// SPDX-License-Identifier: Apache-2.0
// A drive with known truth: white slip noise of known density, noisy poses at window boundaries, disjoint windows.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/segment/integrate_segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"

namespace slipwise::tests {

inline const MotionNoise kNoise{.psd_time = {1e-4, 1e-4, 1e-4}, .pose_std_xy = 0.01, .pose_std_yaw = 0.005};

inline Estimate wide_prior(const MotionModel& model, double sigma = 0.2) {
  return {Eigen::VectorXd::Zero(model.size()), sigma * sigma * Eigen::MatrixXd::Identity(model.size(), model.size())};
}

struct SimulationSettings {
  std::uint64_t seed = 1;
  std::size_t windows = 60;
  double window = 5.0;   ///< [s]
  double period = 0.05;  ///< of the inputs [s]
  MotionNoise noise = {};
  bool shared_poses = true;  ///< neighbouring windows share the noisy pose between them, as in a real log
};

struct SimulatedDrive {
  InputHistory inputs;
  std::vector<Segment> segments;
};

/// Inputs that change to a new speed and curvature every two seconds, forwards.
inline InputHistory random_inputs(std::mt19937_64& random, double length, double period) {
  std::uniform_real_distribution<double> speed(0.4, 1.8), yaw(-1.0, 1.0);
  std::vector<double> t, v, vy, omega;
  const auto count = static_cast<std::size_t>(std::lround(length / period)) + 1;
  const auto hold = static_cast<std::size_t>(std::lround(2.0 / period));
  for (std::size_t i = 0; i < count; ++i) {
    t.push_back(static_cast<double>(i) * period);
    v.push_back(i % hold == 0 ? speed(random) : v.back());
    vy.push_back(0.0);
    omega.push_back(i % hold == 0 ? yaw(random) : omega.back());
  }
  return {t, v, vy, omega};
}

inline Eigen::Vector3d normal3(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return {x, y, normal(random)};
}

/// The pose reached from the origin when every step's slip is disturbed by white noise.
inline Pose2 disturbed_motion(const SegmentPath& path, const MotionNoise& noise, std::mt19937_64& random) {
  Pose2 pose;
  for (std::size_t k = 0; k < path.tangents.size(); ++k) {
    Eigen::Vector3d tangent = path.tangents[k];
    const Eigen::Vector3d draw = normal3(random);
    for (Eigen::Index c = 0; c < 3; ++c) {
      tangent[c] += std::sqrt(noise.psd_time[static_cast<std::size_t>(c)] * path.drive[k].duration) * draw[c];
    }
    pose = compose(pose, exp(tangent));
  }
  return pose;
}

inline Pose2 measured_pose(const Pose2& pose, const MotionNoise& noise, std::mt19937_64& random) {
  const Eigen::Vector3d draw = normal3(random);
  return {pose.x + noise.pose_std_xy * draw.x(), pose.y + noise.pose_std_xy * draw.y(),
          pose.theta + noise.pose_std_yaw * draw.z()};
}

inline SimulatedDrive simulate_drive(const MotionModel& model, const Eigen::VectorXd& truth,
                                     const SimulationSettings& settings) {
  std::mt19937_64 random(settings.seed);
  const double length = settings.window * static_cast<double>(settings.windows);
  SimulatedDrive drive{random_inputs(random, length + 1.0, settings.period), {}};
  Pose2 pose;
  Pose2 observed = measured_pose(pose, settings.noise, random);
  for (std::size_t i = 0; i < settings.windows; ++i) {
    const double start = 0.5 + settings.window * static_cast<double>(i);
    Segment segment{.start = start, .end = start + settings.window};
    const SegmentPath path = integrate_segment(model, truth, drive.inputs, segment);
    pose = compose(pose, disturbed_motion(path, settings.noise, random));
    const Pose2 seen_at_end = measured_pose(pose, settings.noise, random);
    segment.measured = slipwise::measured_pose(between(observed, seen_at_end));
    drive.segments.push_back(segment);
    observed = settings.shared_poses ? seen_at_end : measured_pose(pose, settings.noise, random);
  }
  return drive;
}

/// R of a window: slip noise along the path that `mean` predicts, and the noise of both poses.
inline Eigen::Matrix3d window_noise(const MotionModel& model, const Eigen::VectorXd& mean, const InputHistory& inputs,
                                    const Segment& segment, const MotionNoise& noise) {
  return slip_covariance(integrate_segment(model, mean, inputs, segment), noise) +
         pose_noise_covariance(Pose2::from_vector(rows_of(segment.measured)), noise);
}

}  // namespace slipwise::tests
