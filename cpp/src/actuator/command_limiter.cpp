// SPDX-License-Identifier: Apache-2.0
// Ramps of the four axes of a drive.
#include "slipwise/actuator/command_limiter.hpp"

#include <algorithm>

namespace slipwise {

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
  const BodyTwist asked = asked_for(given);
  tell(asked);
  speed_.place(asked.v);
  yaw_rate_.place(asked.omega);
  const SideSpeeds sides = asked_of_sides(asked.v, asked.omega);
  left_.place(sides.left);
  right_.place(sides.right);
}

void CommandLimiter::reach(const BodyTwist& given, bool speed, bool yaw_rate) {
  const BodyTwist asked = asked_for(given);
  if (speed) {
    speed_.reach(asked.v, speed_.target());
  }
  if (yaw_rate) {
    yaw_rate_.reach(asked.omega, yaw_rate_.target());
  }
  if (sides_ && (speed || yaw_rate)) {
    const SideSpeeds now = asked_of_sides(asked.v, asked.omega);
    const SideSpeeds goal = asked_of_sides(speed_.target(), yaw_rate_.target());
    left_.reach(now.left, left_.limited(goal.left));
    right_.reach(now.right, right_.limited(goal.right));
  }
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

bool CommandLimiter::ramps() const {
  if (speed_.ramps_to(speed_.target()) || yaw_rate_.ramps_to(yaw_rate_.target())) {
    return true;
  }
  if (!sides_) {
    return false;
  }
  const SideSpeeds asked = asked_of_sides(speed_.target(), yaw_rate_.target());
  return left_.ramps_to(left_.limited(asked.left)) || right_.ramps_to(right_.limited(asked.right));
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
  return {0.5 * (sides.left + sides.right), vy_, (sides.right - sides.left) / limits_.wheel_separation};
}

BodyTwist settled(const CommandLimits& limits, const BodyTwist& command) {
  CommandLimiter limiter(limits);
  limiter.tell(command);
  return limiter.target();
}

}  // namespace slipwise
