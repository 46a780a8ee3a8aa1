// SPDX-License-Identifier: Apache-2.0
// Means of the twist over half a second, and what changes from one to the next.
#include "slipwise/online/body_rates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kRateTime = 0.5;         // [s] over which rates are means
constexpr double kLongestRateTime = 1.5;  // [s]; means over longer ones hide what the robot did
constexpr double kFraction = 0.99;        // of the motion that stayed below a rate
constexpr double kClose = 0.26;           // [s] between poses whose way is smooth from one to the next
constexpr double kMilli = 1e3;
constexpr double kLeast = 2e-3;  // [mm, mrad] counts as no scatter: what is less is not counted by a range
// By so many standard deviations the greatest hundredth of noisy numbers is too large: of rates, where a drive is near
// its greatest for a twentieth of its way; of changes, which are mostly small, more.
constexpr double kRateTooLarge = 1.6;
constexpr double kChangeTooLarge = 2.5;
const double kMedianOfTwo = std::sqrt(2.0 * std::numbers::ln2);  // of the length of two normal numbers
constexpr double kMedianOfOne = 0.6745;                          // of the size of one

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

std::array<double, 2> values(const std::array<RobustGreatest, 2>& greatest, double too_large) {
  const auto value = [&](const RobustGreatest& each) { return std::max(each.value(kFraction) - too_large, 0.0); };
  return {value(greatest[0]), value(greatest[1])};
}

/// Of magnitudes counted in mm or mrad.
double median(const SpeedRange& range) {
  const double found = range.quantile(0.5, 0.0);
  return found > 2.0 * kLeast ? found / kMilli : 0.0;
}

}  // namespace

void RobustGreatest::add(double magnitude, double weight) {
  if (std::isfinite(magnitude) && weight > 0.0) {
    range_.add(magnitude, weight);
    greatest_ = std::max(greatest_, magnitude);
  }
}

double RobustGreatest::value(double fraction) const { return std::min(range_.upper(fraction), greatest_); }

void PoseScatter::push(const MeasuredPose& pose) {
  const MeasuredPose& before = last_.back();
  const bool follows = count_ > 0 && before.frame == pose.frame && before.position == pose.position &&
                       later(pose.t, before.t) && !later(pose.t, before.t + kClose);
  count_ = follows ? std::min(count_ + 1, last_.size()) : 1;
  std::ranges::rotate(last_, last_.begin() + 1);
  last_.back() = pose;
  if (count_ < last_.size()) {
    return;
  }
  const auto& [a, b, c, d] = last_;  // a parabola through a, c and d goes by b
  const Eigen::Vector3d weight((b.t - c.t) * (b.t - d.t) / ((a.t - c.t) * (a.t - d.t)),
                               (b.t - a.t) * (b.t - d.t) / ((c.t - a.t) * (c.t - d.t)),
                               (b.t - a.t) * (b.t - c.t) / ((d.t - a.t) * (d.t - c.t)));
  const double scale = kMilli / std::sqrt(1.0 + weight.squaredNorm());
  const double x = b.x - weight.dot(Eigen::Vector3d(a.x, c.x, d.x));
  const double y = b.y - weight.dot(Eigen::Vector3d(a.y, c.y, d.y));
  places_.add(std::max(scale * std::hypot(x, y), kLeast), 1.0);
  if (!pose.position) {
    const double yaw = b.yaw - weight.dot(Eigen::Vector3d(a.yaw, c.yaw, d.yaw));
    yaws_.add(std::max(scale * std::abs(yaw), kLeast), 1.0);
  }
}

double PoseScatter::place() const { return median(places_) / kMedianOfTwo; }
double PoseScatter::yaw() const { return median(yaws_) / kMedianOfOne; }

void BodyRates::push(const MeasuredPose& pose) {
  scatter_.push(pose);
  if (!from_ || from_->frame != pose.frame || from_->position != pose.position ||
      later(pose.t, from_->t + kLongestRateTime)) {
    restart();
    from_ = pose;
    return;
  }
  const double seconds = pose.t - from_->t;
  if (later(kRateTime, seconds)) {
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
  const double rate = kRateTooLarge * std::numbers::sqrt2 / kRateTime;               // of one pose less another
  const double change = kChangeTooLarge * std::sqrt(6.0) / (kRateTime * kRateTime);  // of 1, -2 and 1 of three
  const double place = scatter_.place();
  const double yaw = scatter_.yaw();
  return {.speed = values(speed_, rate * place),
          .yaw_rate = values(yaw_rate_, rate * yaw),
          .acceleration = values(acceleration_, change * place),
          .turning = values(turning_, change * yaw),
          .seconds = seconds_};
}

}  // namespace slipwise
