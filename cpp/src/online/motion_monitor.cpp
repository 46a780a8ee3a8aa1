// SPDX-License-Identifier: Apache-2.0
// Two explanations of a window, weighed by Student t, and an alarm that holds.
#include "slipwise/online/motion_monitor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kWindow = 0.6;           // [s]
constexpr double kShortestWindow = 0.25;  // [s]
constexpr double kStuckFraction = 0.2;    // of the expected motion: a robot that moves by less is stuck,
constexpr double kMovesFraction = 0.5;    // and by more it moves
constexpr double kMisfit = 0.1;           // of the expected motion that a learned model may be off for a moment
constexpr double kVisible = 25.0;         // normalised square of the expected motion from which on its lack would show
constexpr double kOdds = 4.0;             // logarithm of the odds at which a window says that the robot is stuck
constexpr double kStillAsked = 0.5;  // of the window's mean input, below which the robot may have stopped as commanded
constexpr double kLateStep = 0.1;    // [s] in such steps it is tried whether the body or its poses are late,
constexpr int kLateSteps = 8;        // by so many of them at most
constexpr double kLately = 0.1;      // [s] of the last inputs
constexpr double kDof = 8.0;         // of the Student t by which explanations are weighed
constexpr double kExplained = 25.0;  // normalised square beyond which being stuck does not explain a window either
constexpr double kConfirmed = 0.2;   // [s] for which windows must say so
constexpr double kForgotten = 2.0;   // [s] without expected motion, after which its state is unknown
constexpr double kUnasked = 3.0;     // [s] of poses that are kept for a call

double log_student(double square, const Eigen::Matrix3d& scale) {
  return -0.5 * std::log(scale.determinant()) - 0.5 * (kDof + 3.0) * std::log1p(square / kDof);
}

Pose2 at_pose(const MeasuredPose& pose) { return {pose.x, pose.y, pose.yaw}; }

/// The motion between two poses, turned by whole turns to be next to what was expected.
Eigen::Vector3d motion_between(const MeasuredPose& from, const MeasuredPose& to, const Eigen::Vector3d& expected) {
  Eigen::Vector3d measured = between(at_pose(from), at_pose(to)).vector();
  measured.z() = expected.z() + wrap_angle(measured.z() - expected.z());
  return measured;
}

/// Of a motion that goes as expected, a learned model being a little off.
Eigen::Matrix3d covariance_of_motion(const MotionLeg& leg, const Eigen::Matrix3d& noise) {
  const Eigen::Vector3d expected = leg.motion.vector();
  return leg.covariance() + noise + kMisfit * kMisfit * expected * expected.transpose();
}

}  // namespace

MotionMonitor::MotionMonitor(const PoseStd& nominal, double late_factor)
    : nominal_(nominal), late_factor_(late_factor), noise_(nominal) {}

void MotionMonitor::restart() {
  timer_.restart();
  waiting_.clear();
  window_.clear();
  state_ = {};
  suspected_.reset();
  before_.reset();
  asked_ = -std::numeric_limits<double>::infinity();
}

void MotionMonitor::push(const MeasuredPose& pose) {
  MeasuredPose with_ratio = pose;
  with_ratio.std_ratio = accuracy_.ratio(pose.std);
  if (const auto timed = timer_.push(with_ratio, late_factor_)) {
    waiting_.push_back(*timed);
  }
  if (pose.t - asked_ > kUnasked) {
    while (!waiting_.empty() && waiting_.front().pose.t < pose.t - kUnasked) {
      waiting_.pop_front();
    }
  }
}

/// Of a motion between two poses that scatter.
Eigen::Matrix3d MotionMonitor::pose_noise(const Pose2& motion) const {
  const Eigen::Vector3d least = Eigen::Vector3d(nominal_.xy, nominal_.xy, nominal_.yaw).cwiseAbs2() / 4.0;
  const Eigen::Matrix3d each = noise_.variances({}).cwiseMax(least).asDiagonal();
  Eigen::Matrix3d by_start = -Eigen::Matrix3d::Identity();
  by_start(0, 2) = motion.y;
  by_start(1, 2) = -motion.x;
  return by_start * each * by_start.transpose() + each;
}

MotionMonitor::Finding MotionMonitor::judge(const MotionLeg& leg, const MeasuredPose& from, const MeasuredPose& to) {
  const Eigen::Vector3d expected = leg.motion.vector();
  const Eigen::Vector3d measured = motion_between(from, to, expected);
  const Eigen::Matrix3d noise = pose_noise(leg.motion);
  const Eigen::Matrix3d moving = covariance_of_motion(leg, noise);
  const Eigen::Vector3d weighted = solve_innovation(Eigen::Matrix3d(leg.covariance() + noise), expected);
  if (normalised_square(expected, moving) < kVisible) {
    state_.fraction.reset();
    return Finding::Unknown;
  }
  const double fraction = weighted.dot(measured) / weighted.dot(expected);
  state_.fraction = fraction;
  const double part = std::clamp(fraction, 0.0, kStuckFraction);
  const Eigen::Matrix3d still = noise + part * part * leg.covariance();
  const double still_square = normalised_square(measured - part * expected, still);
  log_still_ = log_student(still_square, still);
  if (log_still_ > log_moving(leg, from, to) + kOdds && still_square < kExplained) {
    return Finding::Stuck;
  }
  return fraction > kMovesFraction ? Finding::Moves : Finding::Between;
}

double MotionMonitor::log_moving(const MotionLeg& leg, const MeasuredPose& from, const MeasuredPose& to) const {
  const Eigen::Vector3d expected = leg.motion.vector();
  const Eigen::Matrix3d moving = covariance_of_motion(leg, pose_noise(leg.motion));
  return log_student(normalised_square(motion_between(from, to, expected) - expected, moving), moving);
}

bool MotionMonitor::is_late(const LegKnowledge& known, const MeasuredPose& from, const MeasuredPose& to,
                            const Model& model) const {
  for (int step = 1; step <= kLateSteps; ++step) {
    const double late = kLateStep * step;
    const auto leg = model.leg(known, from.t - late, to.t - late);
    if (leg && log_still_ <= log_moving(*leg, from, to) + kOdds) {
      return true;
    }
  }
  return false;
}

/// The alarm comes once windows agree for a while, and goes when the robot moves or nothing is expected of it for long.
void MotionMonitor::follow(Finding finding, double t, const LegKnowledge& known) {
  if (finding != Finding::Unknown) {
    expected_ = t;
  }
  if (finding == Finding::Stuck) {
    suspected_ = suspected_.value_or(t);
    if (!state_.stuck && !later(*suspected_ + kConfirmed, t)) {
      state_.stuck = true;
      state_.since = suspected_;
      before_ = known;
    }
    return;
  }
  suspected_.reset();
  if (finding == Finding::Moves || later(t, expected_ + kForgotten)) {
    state_.stuck = false;
    state_.since.reset();
    before_.reset();
  }
}

void MotionMonitor::take(const MeasuredPose& pose, const Model& model) {
  if (!window_.empty() && window_.back().frame != pose.frame) {
    window_.clear();
    noise_.pause();
  }
  const LegKnowledge known = before_ ? *before_ : model.known(pose.t);
  if (!window_.empty()) {
    const MeasuredPose& last = window_.back();
    const auto step = !later(pose.t, last.t + kWindow) ? model.leg(known, last.t, pose.t) : std::nullopt;
    if (step) {
      Eigen::Vector3d error = between(at_pose(last), at_pose(pose)).vector() - step->motion.vector();
      error.z() = wrap_angle(error.z());
      noise_.learn(error, pose.std_ratio);
    } else {
      noise_.pause();
    }
  }
  window_.push_back(pose);
  while (later(pose.t - kWindow, window_.front().t)) {
    window_.pop_front();
  }
  const MeasuredPose& first = window_.front();
  const auto leg = !later(first.t + kShortestWindow, pose.t) ? model.leg(known, first.t, pose.t) : std::nullopt;
  if (!leg) {
    state_.fraction.reset();
  }
  Finding finding = leg ? judge(*leg, first, pose) : Finding::Unknown;
  const double lately = model.asked(pose.t - kLately, pose.t);
  const bool asked = lately > 0.0 && lately >= kStillAsked * model.asked(first.t, pose.t);
  if (finding == Finding::Stuck && !asked) {
    finding = Finding::Unknown;
  }
  if (finding == Finding::Stuck && !state_.stuck && is_late(known, first, pose, model)) {
    finding = Finding::Between;
  }
  follow(finding, pose.t, known);
}

MotionState MotionMonitor::at(double t, double known_until, const Model& model) {
  asked_ = t;
  while (!waiting_.empty() && waiting_.front().pose.t <= known_until) {
    const MeasuredPose pose = waiting_.front().pose;
    waiting_.pop_front();
    take(pose, model);
  }
  if (!window_.empty() && later(t, window_.back().t + kForgotten)) {  // no poses: unknown
    state_ = {};
    suspected_.reset();
    before_.reset();
  }
  return state_;
}

}  // namespace slipwise
