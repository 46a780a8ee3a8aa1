// SPDX-License-Identifier: Apache-2.0
// Limits of the drive as they act: what it was commanded, and what its ramps hold meanwhile
// (derivations/actuator.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "slipwise/actuator/axis_limit.hpp"
#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {

/// The set speed of one axis, which follows its target as fast as it may, or the axis itself behind its lag. A
/// history holds thousands of pieces, so its steps are inline.
class AxisRamp {
 public:
  explicit AxisRamp(const AxisLimits& limits) : limits_(limits) {}

  /// What the axis makes of a command that is held for long.
  double limited(double command) const { return slipwise::limited(limits_, command); }
  void aim(double command) {
    target_ = limited(command);
    jump();
  }
  /// On its way to `target` it has come as far as `state`, if it was not yet so far.
  void reach(double state, double target) {
    const double done = state - state_, whole = target - state_;
    if (done * whole > 0.0) {
      state_ = std::abs(done) < std::abs(whole) ? state : target;
    }
  }
  /// Now it is `state`, however that came about.
  void place(double state) { state_ = state; }
  double state() const { return state_; }
  double target() const { return target_; }
  /// No ramp takes longer; 0 where it goes at once [s].
  double seconds_to(double target) const {
    if (limits_.slew_rate_lag > 0.0 && !ramps_to(target)) {
      return 0.0;
    }
    const bool turns = state_ * target < 0.0;
    return turns ? std::abs(state_) / limits_.slew_rate_down + std::abs(target) / limits_.slew_rate_up +
                       limits_.slew_rate_lag * std::log1p(std::abs(state_ / target))
                 : std::abs(target - state_) / rate_towards(target);
  }
  /// Whether that takes any time.
  bool ramps_to(double target) const {
    const bool turns = state_ * target < 0.0;
    if (const double lag = limits_.slew_rate_lag; lag > 0.0) {
      const double rate = turns ? std::min(limits_.slew_rate_down, limits_.slew_rate_up) : rate_towards(target);
      return std::abs(target - state_) > rate * lag;
    }
    return state_ != target && (turns ? std::isfinite(limits_.slew_rate_down) || std::isfinite(limits_.slew_rate_up)
                                      : std::isfinite(rate_towards(target)));
  }
  /// The mean over a piece, of which `taken` seconds pass [s].
  double mean_over(double piece, double taken) {
    if (state_ == target_) {
      return state_;
    }
    if (limits_.slew_rate_lag > 0.0) {
      const double kept = kept_near(piece);
      state_ = lag_output(state_, kept, limits_.slew_rate_lag, taken);
      return kept;
    }
    if (taken == piece) {
      return follow(piece) / piece;
    }
    AxisRamp whole = *this;
    follow(taken);
    return whole.follow(piece) / piece;
  }

 private:
  double rate_towards(double goal) const {
    return std::abs(goal) < std::abs(state_) ? limits_.slew_rate_down : limits_.slew_rate_up;
  }
  /// Where it turns, zero comes first.
  double next_goal() const { return state_ * target_ < 0.0 ? 0.0 : target_; }

  /// Goes where no rate limits it, in no time.
  void jump() {
    while (limits_.slew_rate_lag == 0.0 && state_ != target_ && std::isinf(rate_towards(next_goal()))) {
      state_ = next_goal();
    }
  }

  /// What of the target a lag may be given for a piece, so that it changes no quicker than the rates.
  double kept_near(double piece) const {
    const double closes = LagDecay(limits_.slew_rate_lag, piece).gone;
    const double gap = target_ - state_, wanted = std::abs(gap) * closes;
    const bool turns = state_ * target_ < 0.0;
    double moved = std::min(wanted, piece * (turns ? limits_.slew_rate_down : rate_towards(target_)));
    if (turns && moved > std::abs(state_)) {  // and from zero on for the rest of the piece
      const double rest = piece * (1.0 - std::abs(state_) / moved);
      moved = std::min(moved, std::abs(state_) + limits_.slew_rate_up * rest);
    }
    return moved < wanted ? state_ + std::copysign(moved / closes, gap) : target_;
  }

  /// Goes on for `seconds`; returns the integral.
  double follow(double seconds) {
    double integral = 0.0;
    for (int phase = 0; phase < 2 && state_ != target_; ++phase) {
      const double goal = next_goal();
      const double rate = rate_towards(goal);
      const double gap = goal - state_;
      const bool arrives = !(std::abs(gap) > rate * seconds);
      const double next = arrives ? goal : state_ + std::copysign(rate * seconds, gap);
      const double taken = arrives ? std::abs(gap) / rate : seconds;
      integral += 0.5 * (state_ + next) * taken;
      state_ = next;
      seconds -= taken;
    }
    return integral + state_ * seconds;
  }

  AxisLimits limits_;
  double state_ = 0.0;
  double target_ = 0.0;
};

/// The limits of the commands, and behind them those of both sides. It begins at rest.
class CommandLimiter {
 public:
  explicit CommandLimiter(const CommandLimits& limits);

  /// It was commanded this for long.
  void settle(const BodyTwist& command);
  /// It gives out `given` now, and was commanded so.
  void place(const BodyTwist& given);
  /// The drive was measured to do what `given` keeps: ramps of the speed or of the yaw rate, and those of both sides,
  /// have come at least as far.
  void reach(const BodyTwist& given, bool speed, bool yaw_rate);
  /// It is commanded this from now on; vy passes as it is.
  void tell(const BodyTwist& command);

  /// No ramp takes longer; 0 where all are over [s].
  double seconds_left() const;
  /// Whether some ramp takes any time.
  bool ramps() const;
  /// What it gives once all ramps are over.
  BodyTwist target() const;
  /// The mean over a piece, of which `taken` seconds pass [s]. The sides follow the mean of the piece.
  BodyTwist mean_over(double piece, double taken);

  /// What the ramps of speed, yaw rate, left and right side hold [m/s, rad/s, m/s, m/s].
  std::array<double, 4> state() const { return {speed_.state(), yaw_rate_.state(), left_.state(), right_.state()}; }

 private:
  BodyTwist joined(double v, double omega, const SideSpeeds& sides) const;
  BodyTwist asked_for(const BodyTwist& given) const {
    return sides_ ? BodyTwist{given.v / limits_.gain_v, given.vy, given.omega / limits_.gain_omega} : given;
  }
  SideSpeeds asked_of_sides(double v, double omega) const { return side_speeds(limits_, {v, vy_, omega}); }

  CommandLimits limits_;
  bool sides_;
  double vy_ = 0.0;
  AxisRamp speed_, yaw_rate_, left_, right_;
};

/// The part of a command that remains if it is held for long.
/// \throws std::invalid_argument as `check` does.
BodyTwist settled(const CommandLimits& limits, const BodyTwist& command);

}  // namespace slipwise
