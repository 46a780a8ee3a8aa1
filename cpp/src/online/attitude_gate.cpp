// SPDX-License-Identifier: Apache-2.0
// Counts of steep attitudes, and their mean.
#include "slipwise/online/attitude_gate.hpp"

#include <cmath>
#include <numbers>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;
constexpr double kMounted = std::numbers::sqrt2 / 2.0;      // cosine of the tilt from which on it is that of a mounting
constexpr double kSteepest = 0.5;                           // cosine of a tilt that no robot drives on
constexpr double kLevelPitch = std::numbers::pi / 4.0;      // [rad] beyond which the yaw of a sensor is not its robot's
constexpr double kWholeTurn = 2.0 * std::numbers::pi;       // [rad] what is more is no angle
constexpr double kAskew = 20.0 * std::numbers::pi / 180.0;  // [rad] by which a mounting is off whole quarters at most

/// The same attitude with a pitch of at most a quarter of a turn.
Tilt in_one_turn(const Tilt& tilt) {
  const Tilt wrapped{tilt.t, wrap_angle(tilt.roll), wrap_angle(tilt.pitch)};
  if (std::abs(wrapped.pitch) <= kQuarter) {
    return wrapped;
  }
  return {tilt.t, wrap_angle(wrapped.roll + std::numbers::pi), wrap_angle(std::numbers::pi - wrapped.pitch)};
}

/// Cosine of the angle between the vertical and what is up.
double upright(const Tilt& tilt) { return std::cos(tilt.roll) * std::cos(tilt.pitch); }

}  // namespace

AttitudeMounting AttitudeGate::mounting() const {
  if (!(2.0 * steep_ > seen_)) {
    return {};
  }
  const double roll = std::atan2(sin_roll_, cos_roll_);
  const double pitch = pitch_ / steep_;
  const double quarters = wrap_angle(kQuarter * std::round(roll / kQuarter));
  const bool rolled =
      quarters != 0.0 && std::abs(wrap_angle(roll - quarters)) <= kAskew && std::abs(pitch) < kLevelPitch;
  return rolled ? AttitudeMounting{.kind = AttitudeMounting::Kind::Rolled, .roll = quarters}
                : AttitudeMounting{.kind = AttitudeMounting::Kind::Other, .roll = roll, .pitch = pitch};
}

std::optional<Tilt> AttitudeGate::level(const Tilt& measured) {
  if (std::abs(measured.roll) > kWholeTurn || std::abs(measured.pitch) > kWholeTurn) {
    return std::nullopt;
  }
  const Tilt tilt = in_one_turn(measured);
  seen_ += 1.0;
  if (upright(tilt) < kMounted) {
    steep_ += 1.0;
    cos_roll_ += std::cos(tilt.roll);
    sin_roll_ += std::sin(tilt.roll);
    pitch_ += tilt.pitch;
  }
  const AttitudeMounting mounted = mounting();
  const Tilt robot{tilt.t, wrap_angle(tilt.roll - mounted.roll), tilt.pitch};
  if (mounted.kind == AttitudeMounting::Kind::Other || upright(robot) < kSteepest) {
    return std::nullopt;
  }
  return robot;
}

}  // namespace slipwise
