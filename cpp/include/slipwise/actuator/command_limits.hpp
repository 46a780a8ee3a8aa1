// SPDX-License-Identifier: Apache-2.0
// What a drive does to its commands before it follows them: dead-band, saturation, and rate limits
// (derivations/actuator.md).
#pragma once

#include <compare>
#include <limits>

#include "slipwise/actuator/input_history.hpp"

namespace slipwise {

/// Limits of one axis of the drive, the same for both signs; the defaults are the identity.
struct AxisLimits {
  double dead_band = 0.0;  ///< what is slower gives zero, the rest passes as it is [m/s or rad/s]
  double saturation = std::numeric_limits<double>::infinity();      ///< no faster [m/s or rad/s]
  double slew_rate_up = std::numeric_limits<double>::infinity();    ///< away from zero no quicker [m/s^2 or rad/s^2]
  double slew_rate_down = std::numeric_limits<double>::infinity();  ///< towards zero no quicker [m/s^2 or rad/s^2]
  /// Zero: the slew rates are of the commands. Else they are of the drive itself, behind a lag of this time constant,
  /// and the commands are kept as near to it as that asks [s].
  double slew_rate_lag = 0.0;

  auto operator<=>(const AxisLimits&) const = default;
};

/// Limits of the commands, as a controller has them, and then of the two sides of a skid-steered or differential drive,
/// as its motors have them. Both sides are built alike.
struct CommandLimits {
  AxisLimits speed = {};
  AxisLimits yaw_rate = {};
  AxisLimits side = {};           ///< of each side's speed, v -+ omega * wheel_separation / 2
  double wheel_separation = 1.0;  ///< [m] between the sides
  double gain_v = 1.0;            ///< of the speed that is asked of the sides over the limited command [-]
  double gain_omega = 1.0;        ///< of the yaw rate [-]

  bool operator==(const CommandLimits&) const = default;
};

/// Whether nothing is limited.
bool unlimited(const CommandLimits& limits);
/// Whether the sides are limited; if not, separation and gains have no effect.
bool limits_sides(const CommandLimits& limits);

/// Whether an axis, or some axis, ramps.
bool limits_rates(const AxisLimits& limits);
bool limits_rates(const CommandLimits& limits);
/// \throws std::invalid_argument when a limit is negative or not a number, or a rate, saturation, wheel_separation or
/// gain not positive.
void check(const CommandLimits& limits);

/// The commands behind the limits of speed and yaw rate alone, in front of those of the sides.
CommandLimits channel_limits(const CommandLimits& limits);

/// What a twist asks of the left and the right side.
struct SideSpeeds {
  double left, right;
};
inline SideSpeeds side_speeds(const CommandLimits& limits, const BodyTwist& twist) {
  const double v = limits.gain_v * twist.v;
  const double half = 0.5 * limits.gain_omega * twist.omega * limits.wheel_separation;
  return {v - half, v + half};
}

inline constexpr double kRampPiece = 0.02;  ///< [s]

/// Into how many equal pieces a command that is held for `hold` seconds is cut while its drive ramps.
int ramp_pieces(double hold, double longest_piece = kRampPiece);

/// The held commands after dead-band, saturation and rate limits; vy passes as it is. The drive starts at rest.
/// A ramp becomes held pieces of its mean, from the command's stamp on. Nothing depends on commands stamped later: the
/// pieces divide the time that the command before was held, into parts of `longest_piece` [s] at most, so commands at
/// equal intervals are cut exactly. A piece that a command cuts short keeps the mean of the whole one: its distance
/// errs by no more than rate * longest_piece^2 / 8.
/// \throws std::invalid_argument as `check` does, and when the longest piece is not positive.
InputHistory limited_inputs(const InputHistory& commands, const CommandLimits& limits,
                            double longest_piece = kRampPiece);

}  // namespace slipwise
