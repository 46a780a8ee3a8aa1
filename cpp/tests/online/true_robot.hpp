// SPDX-License-Identifier: Apache-2.0
// A robot whose true poses are known, as streams of measurements: inputs at 100 Hz, poses at 20 Hz, with seeded noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "slipwise/lie/angle.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/recording.hpp"
#include "streamed_robot.hpp"

namespace slipwise::tests {

/// A span of time [s], by default none.
struct Span {
  double begin = 0.0;
  double end = 0.0;
  bool holds(double t) const { return t >= begin && t < end; }
};

struct TrueDrive {
  std::uint64_t seed = 1;
  double seconds = 60.0;
  bool wheels = false;       ///< wheel speeds come, instead of commands
  double pose_xy = 0.03;     ///< [m]
  double pose_yaw = 0.02;    ///< [rad]
  double correlation = 0.0;  ///< time constant of the poses' errors [s]; without one they are white
  double slip_std = 0.01;    ///< of white slip, as sqrt of its density [m/sqrt(s), rad/sqrt(s)]
  Span gap = {};             ///< without poses
  double late = 0.0;         ///< poses are stamped so much later than they were measured [s]
  Span blocked = {};         ///< the robot does not move whatever its wheels do
};

struct TrueRobot {
  Recording run;
  std::vector<Pose2> pose;  ///< every 10 ms
  Pose2 at(double t) const {
    const auto i = static_cast<std::size_t>(std::lround(t / 0.01));
    return pose[std::min(i, pose.size() - 1)];
  }
};

/// Errors of poses, white or a Gauss-Markov process.
class PoseErrors {
 public:
  explicit PoseErrors(const TrueDrive& drive) : drive_(drive), random_(drive.seed + 1000) {}
  Eigen::Vector3d next(double seconds) {
    const double kept = drive_.correlation > 0.0 ? std::exp(-seconds / drive_.correlation) : 0.0;
    const double fresh = begun_ ? std::sqrt(1.0 - kept * kept) : 1.0;
    for (double& value : error_) {
      value = kept * value + fresh * normal_(random_);
    }
    begun_ = true;
    return {error_.x() * drive_.pose_xy, error_.y() * drive_.pose_xy, error_.z() * drive_.pose_yaw};
  }

 private:
  TrueDrive drive_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d error_ = Eigen::Vector3d::Zero();
  bool begun_ = false;
};

/// The robot follows commands after 0.1 s with a lag of 0.3 s; it drives a tenth less far than its wheels and turns a
/// third less.
inline TrueRobot true_robot(const TrueDrive& drive) {
  constexpr double kStep = 0.01;
  constexpr int kDelay = 10;
  std::mt19937_64 random(drive.seed);
  std::uniform_real_distribution<double> speed(0.3, 1.2), yaw_rate(-0.8, 0.8);
  std::normal_distribution<double> normal;
  PoseErrors errors(drive);
  TrueRobot robot;
  std::vector<BodyTwist> commands;
  BodyTwist wheels{};
  Pose2 pose;
  const auto steps = static_cast<int>(std::lround(drive.seconds / kStep));
  for (int i = 0; i <= steps; ++i) {
    const double t = kStep * i;
    robot.pose.push_back(pose);
    commands.push_back(i % 200 == 0 ? BodyTwist{speed(random), 0.0, yaw_rate(random)} : commands.back());
    if (drive.wheels) {
      robot.run.wheels.push_back({t, {wheels.v + 0.01 * normal(random), 0.0, wheels.omega + 0.01 * normal(random)}});
    } else {
      robot.run.commands.push_back({t, commands.back()});
    }
    if (i % 5 == 0) {
      const Eigen::Vector3d seen = pose.vector() + errors.next(5 * kStep);
      if (!drive.gap.holds(t)) {
        robot.run.poses.push_back({.t = t + drive.late, .x = seen.x(), .y = seen.y(), .yaw = wrap_angle(seen.z())});
      }
    }
    const BodyTwist acts = i >= kDelay ? commands[static_cast<std::size_t>(i - kDelay)] : BodyTwist{};
    const double gone = -std::expm1(-kStep / 0.3);
    wheels.v += (acts.v - wheels.v) * gone;
    wheels.omega += (acts.omega - wheels.omega) * gone;
    const double scatter = drive.slip_std * std::sqrt(kStep);
    const Eigen::Vector3d slip(scatter * normal(random), scatter * normal(random), scatter * normal(random));
    if (!drive.blocked.holds(t)) {
      pose = compose(pose, exp(Eigen::Vector3d(0.9 * wheels.v, 0.0, wheels.omega / 1.5) * kStep + slip));
    }
  }
  return robot;
}

/// How late streams arrive [s].
struct Lateness {
  double inputs = 0.0;
  double poses = 0.0;
};

/// Pushes what is stamped within [begin, end), each stream late by its seconds, in the order of arrival; `arrived` is
/// called with each time of arrival.
template <class Arrived>
void push_within(MotionLearner& learner, const Recording& run, const Span& span, const Lateness& late,
                 const Arrived& arrived) {
  std::vector<Arrival> arrivals;
  const auto add = [&](int stream, const auto& samples, double lateness) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (span.holds(samples[i].t)) {
        arrivals.push_back({samples[i].t + lateness, stream, i});
      }
    }
  };
  add(0, run.commands, late.inputs);
  add(1, run.wheels, late.inputs);
  add(2, run.poses, late.poses);
  push_arrivals(learner, run, std::move(arrivals), arrived);
}

}  // namespace slipwise::tests
