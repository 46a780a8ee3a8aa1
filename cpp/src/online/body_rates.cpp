// SPDX-License-Identifier: Apache-2.0
// Means of the twist over half a second, and what changes from one to the next.
#include "slipwise/online/body_rates.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kInterval = 0.5;   // [s] over which rates are means
constexpr double kLongest = 1.5;    // [s]; means over longer ones hide what the robot did
constexpr double kFraction = 0.99;  // of the motion that stayed below a rate

/// Counts a rate by the way that it makes: much noise at a standstill is no motion.
void add_signed(std::array<RobustGreatest, 2>& greatest, double rate, double seconds) {
  greatest[rate < 0.0 ? 0 : 1].add(std::abs(rate), std::abs(rate) * seconds);
}

/// A reversal does both, away from standstill and towards it.
void add_change(std::array<RobustGreatest, 2>& greatest, double before, double after, double seconds) {
  const double change = std::abs(after - before);
  const bool reversal = before * after < 0.0;
  if (reversal || std::abs(after) > std::abs(before)) {
    greatest[0].add(change / seconds, change);
  }
  if (reversal || std::abs(after) < std::abs(before)) {
    greatest[1].add(change / seconds, change);
  }
}

std::array<double, 2> values(const std::array<RobustGreatest, 2>& greatest) {
  return {greatest[0].value(kFraction), greatest[1].value(kFraction)};
}

}  // namespace

void RobustGreatest::add(double magnitude, double weight) {
  if (std::isfinite(magnitude) && weight > 0.0) {
    range_.add(magnitude, weight);
    greatest_ = std::max(greatest_, magnitude);
  }
}

double RobustGreatest::value(double fraction) const { return std::min(range_.upper(fraction), greatest_); }

void BodyRates::push(const MeasuredPose& pose) {
  if (!from_ || from_->frame != pose.frame || from_->position != pose.position || later(pose.t, from_->t + kLongest)) {
    restart();
    from_ = pose;
    return;
  }
  const double seconds = pose.t - from_->t;
  if (later(kInterval, seconds)) {
    return;
  }
  const Pose2 first{from_->x, from_->y, from_->yaw};
  Pose2 motion = between(first, {pose.x, pose.y, pose.yaw});
  motion.theta = pose.yaw - from_->yaw;
  const Eigen::Vector3d twist = adjoint(sensor_) * log(motion) / seconds;
  take({.v = twist.x(), .vy = twist.y(), .omega = twist.z()}, seconds, !pose.position);
  from_ = pose;
}

void BodyRates::take(const BodyTwist& twist, double seconds, bool turns) {
  add_signed(speed_, twist.v, seconds);
  if (turns) {
    add_signed(yaw_rate_, twist.omega, seconds);
  }
  if (last_) {
    const double apart = 0.5 * (last_seconds_ + seconds);
    add_change(acceleration_, last_->v, twist.v, apart);
    if (turns) {
      add_change(turning_, last_->omega, twist.omega, apart);
    }
  }
  last_ = twist;
  last_seconds_ = seconds;
  seconds_ += seconds;
}

void BodyRates::restart() {
  from_.reset();
  last_.reset();
}

MeasuredRates BodyRates::found() const {
  return {.speed = values(speed_),
          .yaw_rate = values(yaw_rate_),
          .acceleration = values(acceleration_),
          .turning = values(turning_),
          .seconds = seconds_};
}

}  // namespace slipwise
