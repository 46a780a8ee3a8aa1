// SPDX-License-Identifier: Apache-2.0
// Ramps of one lane, and of the four lanes of a drive.
#include "slipwise/actuator/command_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace slipwise {

double LaneRamp::limited(double command) const {
  return std::abs(command) < limits_.dead_band ? 0.0 : std::clamp(command, -limits_.top, limits_.top);
}

void LaneRamp::aim(double command) {
  target_ = limited(command);
  follow(0.0);
}

double LaneRamp::seconds_to(double target) const {
  const bool turns = state_ * target < 0.0;
  return turns ? std::abs(state_) / limits_.braking + std::abs(target) / limits_.acceleration
               : std::abs(target - state_) / rate_towards(target);
}

double LaneRamp::mean_over(double piece, double taken) {
  if (taken == piece) {
    return follow(piece) / piece;
  }
  LaneRamp whole = *this;
  follow(taken);
  return whole.follow(piece) / piece;
}

double LaneRamp::rate_towards(double goal) const {
  return std::abs(goal) < std::abs(state_) ? limits_.braking : limits_.acceleration;
}

/// Goes on for `seconds`; returns the integral.
double LaneRamp::follow(double seconds) {
  double integral = 0.0;
  for (int phase = 0; phase < 2 && state_ != target_; ++phase) {
    const double goal = state_ * target_ < 0.0 ? 0.0 : target_;
    const double rate = rate_towards(goal);
    const double needed = std::abs(goal - state_) / rate;
    const double next = needed <= seconds ? goal : state_ + std::copysign(rate * seconds, goal - state_);
    const double taken = std::min(needed, seconds);
    integral += 0.5 * (state_ + next) * taken;
    state_ = next;
    seconds -= taken;
  }
  return integral + state_ * seconds;
}

CommandLimiter::CommandLimiter(const CommandLimits& limits)
    : limits_(limits),
      sides_(limits_sides(limits)),
      speed_(limits.speed),
      yaw_rate_(limits.yaw_rate),
      left_(limits.side),
      right_(limits.side) {
  check(limits);
}

void CommandLimiter::settle(const BodyTwist& command) {
  tell(command);
  speed_.place(speed_.target());
  yaw_rate_.place(yaw_rate_.target());
  const SideSpeeds asked = asked_of_sides(speed_.target(), yaw_rate_.target());
  left_.place(left_.limited(asked.left));
  right_.place(right_.limited(asked.right));
}

void CommandLimiter::place(const BodyTwist& given) {
  const BodyTwist asked =
      sides_ ? BodyTwist{given.v / limits_.gain_v, given.vy, given.omega / limits_.gain_omega} : given;
  tell(asked);
  speed_.place(asked.v);
  yaw_rate_.place(asked.omega);
  const SideSpeeds sides = asked_of_sides(asked.v, asked.omega);
  left_.place(sides.left);
  right_.place(sides.right);
}

void CommandLimiter::tell(const BodyTwist& command) {
  speed_.aim(command.v);
  yaw_rate_.aim(command.omega);
  vy_ = command.vy;
}

double CommandLimiter::seconds_left() const {
  const double channels = std::max(speed_.seconds_to(speed_.target()), yaw_rate_.seconds_to(yaw_rate_.target()));
  if (!sides_) {
    return channels;
  }
  const SideSpeeds asked = asked_of_sides(speed_.target(), yaw_rate_.target());
  return channels +
         std::max(left_.seconds_to(left_.limited(asked.left)), right_.seconds_to(right_.limited(asked.right)));
}

BodyTwist CommandLimiter::target() const {
  const SideSpeeds asked = asked_of_sides(speed_.target(), yaw_rate_.target());
  return joined(speed_.target(), yaw_rate_.target(), {left_.limited(asked.left), right_.limited(asked.right)});
}

BodyTwist CommandLimiter::mean_over(double piece, double taken) {
  const double v = speed_.mean_over(piece, taken);
  const double omega = yaw_rate_.mean_over(piece, taken);
  if (!sides_) {
    return {v, vy_, omega};
  }
  const SideSpeeds asked = asked_of_sides(v, omega);
  left_.aim(asked.left);
  right_.aim(asked.right);
  return joined(v, omega, {left_.mean_over(piece, taken), right_.mean_over(piece, taken)});
}

BodyTwist CommandLimiter::joined(double v, double omega, const SideSpeeds& sides) const {
  if (!sides_) {
    return {v, vy_, omega};
  }
  return {0.5 * (sides.left + sides.right), vy_, (sides.right - sides.left) / limits_.track};
}

BodyTwist settled(const CommandLimits& limits, const BodyTwist& command) {
  CommandLimiter limiter(limits);
  limiter.tell(command);
  return limiter.target();
}

}  // namespace slipwise
