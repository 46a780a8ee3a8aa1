// SPDX-License-Identifier: Apache-2.0
// Where the robot is, asked of a learner: what it knew at each time predicts the motion between poses.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/motion_learner.hpp"
#include "slipwise/online/student_t.hpp"

namespace slipwise {
namespace {

constexpr double kOffsets = 1.5;    // [s] states are kept for longer than streams are late: no clock offset is larger
constexpr double kOfPoses = 5.0;    // [s] horizon whose errors say how large those of legs are beside poses: there the
                                    // noise of the poses, which the filter knows by itself, counts least,
constexpr double kOfWindow = 1.0;   // [s] and beside a window of the monitor
constexpr double kInstant = 1e-3;   // [s] over which the twist is taken,
constexpr double kTwistTime = 0.1;  // [s] and over which its white noise is averaged
constexpr double kUnknownSpeed = 1.0;  // [m/s, rad/s] of a robot of which no input is known,
constexpr double kLongUnknown = 1.0;   // [s] for which it may go on as it did
constexpr double kLearned = 20.0;      // [s] of segments, before which the model is not held against the robot
constexpr double kCommanded = 0.5;     // [s] before a stretch, from which on its inputs must be known

/// Variance of a Student t over that of the normal with its scale.
double spread(const StudentT& student) { return student.inflation * student.dof / std::max(student.dof - 2.0, 1.0); }

}  // namespace

PoseFilterSettings pose_filter_settings(const LearnerSettings& settings) {
  const MotionNoise& shape = settings.hypotheses.filter.noise.shape;
  return {.nominal = {.xy = shape.pose_std_xy, .yaw = shape.pose_std_yaw},
          .late_factor = settings.stream.rules.late_factor,
          .keep = settings.stream.latency + kOffsets};
}

/// What was known a while before `t` [s], so that it does not depend on how fast segments are learned.
LegKnowledge MotionLearner::leg_knowledge(double t, double horizon) {
  const Knowledge& known = known_at(t - kReady);
  return {.posterior = known.motion,
          .disturbance = known.disturbance,
          .slip = recent_slip_.after(*known.disturbance, known.motion, recent_before(t - kReady)),
          .inflation = spread(student_at(t, horizon, known.motion->structure))};
}

MotionLeg MotionLearner::leg(const LegKnowledge& known, double start, double end) const {
  return motion_leg(known, stream_.stretch(start, end, leg_memory(*known.posterior)));
}

/// Covariance of the motion where the input is not known: the robot may do what it ever did.
Eigen::Matrix3d MotionLearner::unknown_motion(double start, double end) const {
  const InputBuffer& inputs = stream_.inputs();
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

std::optional<Odometry> MotionLearner::odometry() {
  const double now = stream_.newest();
  const auto legs = [this](double start, double end) {
    MotionLeg found = leg(leg_knowledge(end, kOfPoses), start, end);
    found.white += unknown_motion(start, end);
    return found;
  };
  const std::optional<SensorPose> sensor = pose_filter_.at(now, legs);
  if (!sensor) {
    return std::nullopt;
  }
  const MotionLeg instant = legs(now - kInstant, now);
  const Pose2 base = compose(sensor->pose, inverse(instant.sensor));
  const Eigen::Matrix3d at_base = transition(sensor->pose, base);
  const Eigen::Matrix3d of_sensor = adjoint(instant.sensor);
  const Eigen::Vector3d twist = of_sensor * log(instant.motion) / kInstant;
  const Eigen::Matrix3d lasting = (instant.covariance() - instant.white) / (kInstant * kInstant);
  const Eigen::Matrix3d twist_covariance = lasting + instant.white / (kInstant * kTwistTime);
  return Odometry{.t = clock_.stamp(now),
                  .frame = sensor->frame,
                  .pose = base,
                  .covariance = at_base * sensor->covariance * at_base.transpose(),
                  .twist = {.v = twist.x(), .vy = twist.y(), .omega = twist.z()},
                  .twist_covariance = of_sensor * twist_covariance * of_sensor.transpose(),
                  .since_pose = sensor->since_pose};
}

MotionState MotionLearner::motion_monitor() {
  const InputBuffer& inputs = stream_.inputs();
  const double inputs_until = inputs.empty() ? -std::numeric_limits<double>::infinity() : inputs.newest();
  const double known_until = std::max(inputs_until, stream_.newest() - settings_.stream.latency);
  const auto leg_of = [this](const LegKnowledge& known, double start, double end) -> std::optional<MotionLeg> {
    const bool commanded = !stream_.inputs().unknown_since(start - kCommanded, end);
    return commanded && seconds_ >= kLearned ? std::optional(leg(known, start, end)) : std::nullopt;
  };
  const auto asked = [&inputs](double start, double end) {
    const InputBuffer::Driven driven = inputs.driven(start, end);
    return end > start ? (driven.distance + kTurnRadius * driven.angle) / (end - start) : 0.0;
  };
  MotionState state =
      monitor_.at(stream_.newest(), known_until,
                  {.known = [this](double t) { return leg_knowledge(t, kOfWindow); }, .leg = leg_of, .asked = asked});
  if (state.since) {
    state.since = clock_.stamp(*state.since);
  }
  return state;
}

}  // namespace slipwise
