// SPDX-License-Identifier: Apache-2.0
// Twists between poses teach the curves; segments take those that were known before them.
#include "slipwise/online/car_stream.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/learner_times.hpp"

namespace slipwise {
namespace {

constexpr double kTwistTime = 0.2;         // [s] between the poses of a twist; shorter, noise of poses hides the motion
constexpr double kFresh = 0.05;            // [s] between moments at which what the car does is known
constexpr double kLongestTwistTime = 1.0;  // [s] of a twist; over longer ones a car does too much
constexpr double kBefore = 5.0;   // [s] of twists before a segment, which delays and lags behind the curves ask for
constexpr double kLongAgo = 1e5;  // [s] the first of them was held for

BodyTwist faster(const BodyTwist& a, const BodyTwist& b) {
  return {.v = std::abs(a.v) > std::abs(b.v) ? a.v : b.v,
          .vy = 0.0,
          .omega = std::abs(a.omega) > std::abs(b.omega) ? a.omega : b.omega};
}

}  // namespace

CarStream::CarStream() : CarStream({}, {}, 1.0) {}

CarStream::CarStream(const CarPrior& prior, const Pose2& sensor, double unknown_after)
    : sensor_(sensor), given_(unknown_after), filter_(prior) {
  if (prior.held) {
    follower_.emplace(prior, *prior.held);
  }
  known_.push_back(
      {.until = -kNever, .curves = filter_.curves(), .straight = filter_.straight(), .lasting = filter_.lasting()});
}

void CarStream::start_run() {
  given_.clear();
  since_.reset();
  last_.reset();
  now_ = {};
  motions_.clear();
  known_.erase(known_.begin(), known_.end() - 1);
  known_.front().until = -kNever;  // all is known by then, and stamps may begin again
}

const CarStream::KnownCurves& CarStream::known_at(double t) const {
  for (const KnownCurves& known : known_ | std::views::reverse) {
    if (!later(known.until, t)) {
      return known;
    }
  }
  return known_.front();
}

CarState CarStream::state_at(double t, double latency) const {
  return last_ && t > last_->t ? advanced(known_at(last_->t - latency).lasting, now_, last_->twist, t - last_->t)
                               : now_;
}

BodyTwist CarStream::expected(const InputSample& command, double latency) const {
  if (!std::isfinite(command.t) || !std::isfinite(command.twist.v) || !std::isfinite(command.twist.omega)) {
    return command.twist;
  }
  const CarCurves& car = known_at(command.t - latency).lasting;
  const CarState goal{.speed = car.speed(command.twist.v), .steering = command.twist.omega};
  return faster(car_twist(car, state_at(command.t, latency)), car_twist(car, goal));
}

void CarStream::push_command(const InputSample& command, double latency) {
  now_ = state_at(command.t, latency);
  last_ = command;
  given_.push(command);
}

void CarStream::push_pose(const MeasuredPose& pose) {
  if (!since_) {
    const double begin = given_.empty() ? pose.t : std::min(pose.t, given_.first());
    filter_.start_run(begin);
    if (follower_) {
      follower_->start_run(begin);
    }
  }
  const double seconds = since_ ? pose.t - since_->t : 0.0;
  const bool joined = since_ && pose.frame == since_->frame && !later(seconds, kLongestTwistTime);
  const bool part = joined && later(kTwistTime, seconds);
  if (part && later(kFresh, motions_.empty() ? seconds : pose.t - std::max(since_->t, motions_.back().t))) {
    return;
  }
  const bool given = !given_.unknown_since(filter_.until(), pose.t).has_value();
  const InputHistory commands = given_.slice(filter_.until() - CarCurveFilter::reach(), pose.t, SliceKind::Commands);
  std::optional<BodyTwist> measured;
  if (joined && given) {
    const Pose2 moved = between({since_->x, since_->y, since_->yaw}, {pose.x, pose.y, pose.yaw});
    const Eigen::Vector3d twist = adjoint(sensor_) * log(moved) / seconds;
    measured = {.v = twist.x(), .vy = twist.y(), .omega = twist.z()};
  }
  if (part) {  // too short to learn from
    if (measured) {
      const CarCurveFilter& filter = follower_ ? *follower_ : filter_;
      motions_.push_back(filter.motion(commands, pose.t, *measured, seconds / kTwistTime));
    }
    return;
  }
  filter_.follow(commands, pose.t, measured ? &*measured : nullptr);
  if (follower_) {
    follower_->follow(commands, pose.t, measured ? &*measured : nullptr);
  }
  if (measured) {
    motions_.push_back((follower_ ? *follower_ : filter_).motion());
    known_.push_back(
        {.until = pose.t, .curves = filter_.curves(), .straight = filter_.straight(), .lasting = filter_.lasting()});
  }
  since_ = pose;
}

void CarStream::drop_before(double t) {
  given_.drop_before(t);
  while (known_.size() > 1 && known_[1].until < t) {
    known_.pop_front();
  }
  while (motions_.size() > 1 && motions_[1].t < t) {
    motions_.pop_front();
  }
}

InputHistory CarStream::inputs(double start, double end, double known, const std::vector<InputSample>& future) const {
  return twists(car_at(known), given_.slice(start - kLookBack, end, SliceKind::Commands, future), start, end);
}

InputSpread CarStream::spread(double start, double end, double known, const std::vector<InputSample>& future) const {
  const InputHistory commands = given_.slice(start - kLookBack, end, SliceKind::Commands, future);
  const CarDeviations deviations = car_deviations(car_at(known), commands);
  InputSpread found{.deviated = {}, .step = deviations.step};
  for (const CarCurves& car : deviations.cars) {
    found.deviated.push_back(twists(car, commands, start, end));
  }
  return found;
}

InputHistory CarStream::twists(const CarCurves& car, const InputHistory& commands, double start, double end) const {
  CarSpan span{.start = start - kBefore, .end = end};
  for (const KnownMotion& motion : motions_) {
    if (!later(motion.t, start)) {
      span.measured = motion;
    }
  }
  const InputHistory driven = car_twists(car, commands, span);
  std::vector<double> t;
  std::vector<BodyTwist> twist;
  for (std::size_t i = 0; i < driven.size(); ++i) {
    t.push_back(i == 0 ? driven.time(0) - kLongAgo : driven.time(i));
    twist.push_back(driven.sample(i));
  }
  return {std::move(t), std::move(twist)};
}

InputHistory CarStream::baseline(double start, double end, double known) const {
  return car_twists(known_at(known).straight, given_.slice(start, end, SliceKind::Commands),
                    {.start = start, .end = end});
}

}  // namespace slipwise
