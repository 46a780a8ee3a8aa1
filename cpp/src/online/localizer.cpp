// SPDX-License-Identifier: Apache-2.0
// What was known at each time predicts the motion between poses.
#include "slipwise/online/localizer.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/motion_noise.hpp"

namespace slipwise {
namespace {

constexpr double kOfPoses = 5.0;    // [s] horizon whose errors say how large those of legs are beside poses: there the
                                    // noise of the poses, which the filter knows by itself, counts least,
constexpr double kOfWindow = 1.0;   // [s] and beside a window of the monitor
constexpr double kInstant = 1e-3;   // [s] over which the twist is taken,
constexpr double kTwistTime = 0.1;  // [s] and over which its white noise is averaged
constexpr double kUnknownSpeed = 1.0;  // [m/s, rad/s] of a robot of which no input is known,
constexpr double kLongUnknown = 1.0;   // [s] for which it may go on as it did
constexpr double kLearned = 20.0;      // [s] of segments, before which the model is not held against the robot
constexpr double kCommanded = 0.5;     // [s] before a stretch, from which on its inputs must be known

/// Covariance of the motion where the input is not known: the robot may do what it ever did.
Eigen::Matrix3d unknown_motion(const InputBuffer& inputs, double start, double end) {
  const std::optional<double> since = inputs.unknown_since(start, end);
  if (!since) {
    return Eigen::Matrix3d::Zero();
  }
  const bool before = !inputs.empty() && inputs.first() <= start;
  const double last = before ? inputs.newest() + inputs.unknown_after() : start;
  const double already = std::clamp(start - last, 0.0, kLongUnknown);
  const double seconds = end - *since;
  const BodyTwist top = inputs.fastest_until(end);
  const double speed = top.v > 0.0 ? top.v : kUnknownSpeed;
  const double rate = top.omega > 0.0 ? top.omega : kUnknownSpeed;
  const double square = seconds * (seconds + 2.0 * already);
  return Eigen::Vector3d(speed * speed * square, speed * speed * square, rate * rate * square).asDiagonal();
}

/// Covariance of a pose in its frame's axes by a time that is known to `std` [s], where it moves by `rates` in its own.
Eigen::Matrix3d of_time(const Pose2& pose, const Eigen::Vector3d& rates, double std) {
  Eigen::Vector3d moved = std * rates;
  moved.head<2>() = (rotation(pose.theta) * moved.head<2>()).eval();
  return moved * moved.transpose();
}

}  // namespace

Localizer::Localizer(const PoseFilterSettings& settings)
    : filter_(settings), monitor_(settings.nominal, settings.late_factor) {}

void Localizer::restart() {
  filter_.restart();
  monitor_.restart();
}

void Localizer::push(const MeasuredPose& pose) {
  filter_.push(pose);
  monitor_.push(pose);
}

std::optional<Odometry> Localizer::odometry(const MotionNow& motion) {
  const double late = motion.late.mean;
  const auto legs = [&](double start, double end) {
    MotionLeg found = motion.leg(motion.at(std::min(end, motion.newest), kOfPoses), start, end);
    found.white += unknown_motion(motion.inputs, start - late, end - late);
    return found;
  };
  const double now = motion.newest + late;
  const std::optional<SensorPose> sensor = filter_.at(now, legs);
  if (!sensor) {
    return std::nullopt;
  }
  const MotionLeg instant = legs(now - kInstant, now);
  const Pose2 base = compose(sensor->pose, inverse(instant.sensor));
  const Eigen::Matrix3d at_base = transition(sensor->pose, base);
  const Eigen::Matrix3d of_sensor = adjoint(instant.sensor);
  const Eigen::Vector3d rates = log(instant.motion) / kInstant;
  const Eigen::Matrix3d covariance = sensor->covariance + of_time(sensor->pose, rates, motion.late.std);
  const Eigen::Vector3d twist = of_sensor * rates;
  const Eigen::Matrix3d lasting = (instant.covariance() - instant.white) / (kInstant * kInstant);
  const Eigen::Matrix3d twist_covariance = lasting + instant.white / (kInstant * kTwistTime);
  return Odometry{.t = motion.newest,
                  .frame = sensor->frame,
                  .pose = base,
                  .covariance = at_base * covariance * at_base.transpose(),
                  .twist = {.v = twist.x(), .vy = twist.y(), .omega = twist.z()},
                  .twist_covariance = of_sensor * twist_covariance * of_sensor.transpose(),
                  .since_pose = sensor->since_pose};
}

MotionState Localizer::monitor(const MotionNow& motion) {
  const InputBuffer& inputs = motion.inputs;
  const double inputs_until = inputs.empty() ? -std::numeric_limits<double>::infinity() : inputs.newest();
  const double known_until = std::max(inputs_until, motion.newest - motion.latency);
  const auto leg_of = [&](const LegKnowledge& known, double start, double end) -> std::optional<MotionLeg> {
    const bool commanded = !inputs.unknown_since(start - kCommanded, end);
    return commanded && motion.learned >= kLearned ? std::optional(motion.leg(known, start, end)) : std::nullopt;
  };
  const auto asked = [&](double start, double end) {
    const InputBuffer::Driven driven = inputs.driven(start, end);
    return end > start ? (driven.distance + kTurnRadius * driven.angle) / (end - start) : 0.0;
  };
  return monitor_.at(motion.newest, known_until,
                     {.known = [&](double t) { return motion.at(t, kOfWindow); }, .leg = leg_of, .asked = asked});
}

}  // namespace slipwise
