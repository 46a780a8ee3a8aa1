// SPDX-License-Identifier: Apache-2.0
// What a drive does to its commands before it follows them: dead-band, saturation, and rate limits (derivations.md,
// section 4).
#pragma once

#include <cstdint>
#include <limits>

#include "slipwise/actuator/input_track.hpp"

namespace slipwise {

/// Limits of one lane of the drive, the same for both signs; the defaults are the identity.
struct LaneLimits {
  double dead_band = 0.0;  ///< what is slower gives zero, the rest passes as it is [m/s or rad/s]
  double top = std::numeric_limits<double>::infinity();           ///< no faster [m/s or rad/s]
  double acceleration = std::numeric_limits<double>::infinity();  ///< away from zero no quicker [m/s^2 or rad/s^2]
  double braking = std::numeric_limits<double>::infinity();       ///< towards zero no quicker [m/s^2 or rad/s^2]

  bool operator==(const LaneLimits&) const = default;
};

/// What the two lanes are: speed and yaw rate, or the left and the right side of a skid-steered or differential drive.
enum class Lanes : std::uint8_t { Channels, Sides };

struct CommandLimits {
  Lanes lanes = Lanes::Channels;
  LaneLimits first = {};   ///< of the speed, or of the left side
  LaneLimits second = {};  ///< of the yaw rate, or of the right side
  double track = 1.0;      ///< [m] between the sides; channels do not use it

  bool operator==(const CommandLimits&) const = default;
};

/// Whether nothing is limited.
bool unlimited(const CommandLimits& limits);

/// The twist as its two lanes, and back.
struct LanePair {
  double first, second;
};
LanePair to_lanes(const CommandLimits& limits, double v, double omega);
BodyTwist from_lanes(const CommandLimits& limits, const LanePair& lanes, double vy);

inline constexpr double kRampPiece = 0.02;  ///< [s]

/// The held commands after dead-band, saturation and rate limits; vy passes as it is. The drive starts at rest.
/// A ramp becomes held pieces of its mean over `longest_piece` [s]. Nothing depends on commands stamped later, so a
/// piece that a command cuts short keeps the mean of the whole one: its distance errs by no more than
/// rate * longest_piece^2 / 8.
/// \throws std::invalid_argument when a limit is negative or not a number, or a rate, top or track is not positive.
InputTrack limited_track(const InputTrack& commands, const CommandLimits& limits, double longest_piece = kRampPiece);

}  // namespace slipwise
