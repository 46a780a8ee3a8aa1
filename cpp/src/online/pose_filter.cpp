// SPDX-License-Identifier: Apache-2.0
// Prediction leg by leg, updates by poses, and which poses are believed.
#include "slipwise/online/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/innovation.hpp"

namespace slipwise {
namespace {

constexpr double kLongestLeg = 0.5;  // [s] so that a prediction need not begin at the last pose, however old that is
constexpr double kMostLegs = 60.0;   // [s] before which one leg is as good as many
constexpr double kLost = 3600.0;     // [s] without a pose, after which the robot's place is unknown
constexpr double kUnasked = 10.0;    // [s] of poses that are kept for a call
constexpr double kGate = 25.0;       // normalised square beyond which a pose is rejected: one in 10^5
constexpr int kAgree = 3;            // poses that agree with a rejected one until it is followed
constexpr double kCreep = 1e-6;      // [m^2/s, rad^2/s] a robot may be moved by unmeasured motion

constexpr double kUnmodelled = 1e-3;    // [m^2/s, rad^2/s] per misfit, of motion that the inputs say nothing of
constexpr double kFreedom = 3.0;        // mean of a normalised square that is as it should be
constexpr double kMisfitMemory = 50.0;  // poses
constexpr double kMostMisfit = 100.0;
constexpr double kReach = 1.5;        // times the expected motion, within which a robot may be after a rejected pose,
constexpr double kReachNear = 0.3;    // [m]
constexpr double kReachTurned = 0.5;  // [rad] and this
constexpr double kLeastStd = 1e-6;    // [m, rad] of a pose that may be believed,
constexpr double kMostStd = 1e4;      // and beyond which it says nothing

/// What is stated of a pose, or the nominal where nothing is.
PoseStd stated(const PoseStd& of_pose, const PoseStd& nominal) {
  return {.xy = std::clamp(of_pose.xy > 0.0 ? of_pose.xy : nominal.xy, kLeastStd, kMostStd),
          .yaw = std::clamp(of_pose.yaw > 0.0 ? of_pose.yaw : nominal.yaw, kLeastStd, kMostStd)};
}

/// Where the leg ends that begins at `start`, on the way to `end` [s].
double leg_end(double start, double end) {
  const double gap = end - start;
  if (gap <= kLongestLeg) {
    return end;
  }
  return gap > kMostLegs ? end - kMostLegs : start + kLongestLeg;
}

Pose2 vector_pose(const MeasuredPose& pose) { return {pose.x, pose.y, pose.yaw}; }

/// Whether a robot that was at `from` can be at `to`, where it was expected at `expected`.
bool within_reach(const MeasuredPose& from, const Pose2& expected, const MeasuredPose& to) {
  const double path = std::hypot(expected.x - from.x, expected.y - from.y);
  const double turn = std::abs(wrap_angle(expected.theta - from.yaw));
  return std::hypot(to.x - from.x, to.y - from.y) <= kReach * path + kReachNear &&
         std::abs(wrap_angle(to.yaw - from.yaw)) <= kReach * turn + kReachTurned;
}

}  // namespace

PoseFilter::PoseFilter(const PoseFilterSettings& settings) : settings_(settings) {}

void PoseFilter::restart() {
  timer_.restart();
  poses_.clear();
  moments_.clear();
  first_ = 0;
  asked_ = -std::numeric_limits<double>::infinity();
}

void PoseFilter::push(const MeasuredPose& pose) {
  MeasuredPose with_ratio = pose;
  with_ratio.std_ratio = accuracy_.ratio(pose.std);
  const bool late = !timer_.push(pose, settings_.late_factor);
  if (!poses_.empty() && pose.t - poses_.back().pose.t > kLost) {
    moments_.clear();
    first_ += poses_.size();
    poses_.clear();
  }
  poses_.push_back({with_ratio, late});
  while (!moments_.empty() && moments_.back().main.t >= pose.t) {
    moments_.pop_back();
  }
  if (pose.t - asked_ > kUnasked) {  // no call: the filter begins again at the next one
    moments_.clear();
    while (poses_.front().pose.t < pose.t - kUnasked) {
      poses_.pop_front();
      ++first_;
    }
  }
}

void PoseFilter::forget_without(double t) {
  const auto changes = [&](const Moment& moment) { return moment.inputs_until > t; };
  if (!moments_.empty()) {  // the first is older than any input that may still come, or begins at a pose
    moments_.erase(std::find_if(std::next(moments_.begin()), moments_.end(), changes), moments_.end());
  }
}

/// p' = p + R(theta) m; the covariance in the frame's axes, and with the lasting errors.
double PoseFilter::advance(State& state, double t, const Legs& legs, double misfit) {
  const MotionLeg leg = legs(state.t, t);
  if (state.posterior != leg.posterior) {
    state.with_lasting = LastingColumns::Zero(3, leg.spread.cols());  // what was learned since has errors of its own
    state.posterior = leg.posterior;
  }
  const Pose2 next = compose(state.pose, leg.motion);
  const Eigen::Matrix3d phi = transition(state.pose, next);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = rotation(state.pose.theta);
  const Eigen::Matrix3d crossed = phi * state.with_lasting * leg.by_lasting.transpose() * turn.transpose();
  state.covariance = (phi * state.covariance * phi.transpose() + crossed + crossed.transpose() +
                      misfit * turn * leg.covariance() * turn.transpose())
                         .eval();
  state.covariance = (state.covariance + state.covariance.transpose()).eval() / 2.0;
  state.covariance.diagonal().array() += (kCreep + kUnmodelled * (misfit - 1.0)) * (t - state.t);
  state.with_lasting = (phi * state.with_lasting + misfit * turn * leg.spread).eval();
  state.pose = next;
  state.t = t;
  return leg.inputs_until;
}

void PoseFilter::advance(Moment& moment, double t, const Legs& legs) {
  moment.inputs_until = advance(moment.main, t, legs, moment.misfit);
  if (moment.other) {
    advance(*moment.other, t, legs, moment.misfit);
  }
}

PoseFilter::State PoseFilter::started(const MeasuredPose& pose, const PoseNoise& noise) const {
  State state{.t = pose.t, .pose = vector_pose(pose)};
  state.covariance = noise.variances(pose.std_ratio).asDiagonal();
  return state;
}

PoseFilter::Moment PoseFilter::begun(const MeasuredPose& pose, std::size_t next) const {
  const PoseNoise noise(stated(pose.std, settings_.nominal));
  const State state = started(pose, noise);
  return {.main = state,
          .inputs_until = -std::numeric_limits<double>::infinity(),  // it begins at what was measured
          .other = {},
          .noise = noise,
          .after_pose = state,
          .last = pose,
          .used = pose,
          .next = next};
}

/// Variances of what is stated of a pose beyond its scatter: errors that last from one pose to the next.
Eigen::Vector3d PoseFilter::lasting_error(const MeasuredPose& pose, const PoseNoise& noise) const {
  const auto [xy, yaw] = stated(pose.std, settings_.nominal);
  return (Eigen::Vector3d(xy * xy, xy * xy, yaw * yaw) - noise.variances(pose.std_ratio)).cwiseMax(0.0);
}

/// Normalised square of the innovation.
double PoseFilter::distance(const State& state, const MeasuredPose& pose, const PoseNoise& noise) const {
  Eigen::Vector3d innovation = vector_pose(pose).vector() - state.pose.vector();
  innovation.z() = wrap_angle(innovation.z());
  const Eigen::Vector3d variances = noise.variances(pose.std_ratio) + lasting_error(pose, noise);
  return normalised_square(innovation, state.covariance + Eigen::Matrix3d(variances.asDiagonal()));
}

void PoseFilter::correct(State& state, const MeasuredPose& pose, const PoseNoise& noise) {
  Eigen::Vector3d innovation = vector_pose(pose).vector() - state.pose.vector();
  innovation.z() = wrap_angle(innovation.z());
  const Eigen::Matrix3d r = noise.variances(pose.std_ratio).asDiagonal();
  const Eigen::Matrix3d gain = linear_update(state.covariance, Eigen::Matrix3d(Eigen::Matrix3d::Identity()), r);
  state.pose = Pose2::from_vector(state.pose.vector() + gain * innovation);
  state.with_lasting -= (gain * state.with_lasting).eval();
}

/// The motion since the last pose, as measured, minus what was expected.
void PoseFilter::learn_noise(Moment& moment, const MeasuredPose& last, const MeasuredPose& pose) {
  const Pose2& from = moment.after_pose.pose;
  const Eigen::Vector3d measured = vector_pose(pose).vector() - vector_pose(last).vector();
  Eigen::Vector3d error = measured - (moment.main.pose.vector() - from.vector());
  error.head<2>() = (rotation(-moment.main.pose.theta) * error.head<2>()).eval();
  error.z() = wrap_angle(error.z());
  moment.noise.learn(error, pose.std_ratio);
}

/// A rejected pose is followed once those after it agree: each is where the robot can be that was at the last, even by
/// a model that is far off.
void PoseFilter::consider_other(Moment& moment, const MeasuredPose& pose) const {
  const bool agrees = moment.other && moment.last && within_reach(*moment.last, moment.other->pose, pose);
  if (agrees && distance(*moment.other, pose, moment.noise) <= kGate) {
    correct(*moment.other, pose, moment.noise);
  } else {
    moment.other = started(pose, moment.noise);
  }
  moment.agreed = agrees ? moment.agreed + 1 : 0;
  if (moment.agreed >= kAgree) {
    moment.main = *moment.other;
    moment.other.reset();
    moment.agreed = 0;
    moment.used = pose;
    moment.noise.pause();
  }
}

void PoseFilter::use(Moment& moment, const Waiting& waiting) const {
  const MeasuredPose& pose = waiting.pose;
  ++moment.next;
  if (pose.frame != moment.used.frame) {
    moment.main = started(pose, moment.noise);
    moment.other.reset();
    moment.noise.pause();
    moment.after_pose = moment.main;
    moment.last = moment.used = pose;
    return;
  }
  if (waiting.late) {
    moment.noise.pause();
    moment.last.reset();
    moment.after_pose = moment.main;
    return;
  }
  if (moment.last) {
    learn_noise(moment, *moment.last, pose);
  }
  const double square = distance(moment.main, pose, moment.noise);
  const double excess = std::isfinite(square) ? std::min(square, 2.0 * kGate) / kFreedom : 1.0;
  moment.misfit = std::max(moment.misfit + (excess * moment.misfit - moment.misfit) / kMisfitMemory, 1.0);
  moment.misfit = std::min(moment.misfit, kMostMisfit);
  if (square <= kGate) {
    correct(moment.main, pose, moment.noise);
    moment.other.reset();
    moment.agreed = 0;
    moment.used = pose;
  } else {
    consider_other(moment, pose);
  }
  moment.last = pose;
  moment.after_pose = moment.main;
}

void PoseFilter::work(const Legs& legs) {
  if (moments_.empty() && !poses_.empty()) {
    moments_.push_back(begun(poses_.front().pose, first_ + 1));
  }
  while (!moments_.empty() && moments_.back().next < first_ + poses_.size()) {
    Moment moment = moments_.back();
    const Waiting& waiting = pose_at(moment.next);
    const double end = leg_end(moment.main.t, waiting.pose.t);
    advance(moment, end, legs);
    if (end == waiting.pose.t) {
      use(moment, waiting);
    }
    moments_.push_back(std::move(moment));
  }
}

/// Poses before the first moment that is kept are not needed any more.
void PoseFilter::trim(double t) {
  while (moments_.size() > 1 && moments_[1].main.t <= t - settings_.keep) {
    moments_.pop_front();
  }
  while (first_ + 1 < moments_.front().next) {
    poses_.pop_front();
    ++first_;
  }
}

std::optional<SensorPose> PoseFilter::at(double t, const Legs& legs) {
  asked_ = t;
  if (poses_.empty() || t - poses_.back().pose.t > kLost) {
    return std::nullopt;
  }
  work(legs);
  double end = leg_end(moments_.back().main.t, t);
  while (end < t) {
    Moment moment = moments_.back();
    advance(moment, end, legs);
    moments_.push_back(std::move(moment));
    trim(t);
    end = leg_end(end, t);
  }
  trim(t);
  const Moment& moment = moments_.back();
  State now = moment.main;
  if (t > now.t) {
    advance(now, t, legs, moment.misfit);
  }
  Eigen::Matrix3d covariance = now.covariance;
  covariance.diagonal() += lasting_error(moment.used, moment.noise);
  return SensorPose{
      .t = t, .pose = now.pose, .covariance = covariance, .frame = moment.used.frame, .since_pose = t - moment.used.t};
}

}  // namespace slipwise
