// SPDX-License-Identifier: Apache-2.0
// How much the slip rates and the measured poses scatter (derivations/uncertainty.md).
#pragma once

#include <array>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {

/// Noise of the slip rates per channel (lon, lat, ang) and of the measured poses.
/// `Motion` below is |v| + kTurnRadius |omega| [m/s] for lon and lat, |omega| + |v| / kStraightRadius [rad/s] for ang.
struct MotionNoise {
  std::array<double, 3> psd_time{};    ///< white, while moving [m^2/s, m^2/s, rad^2/s]
  std::array<double, 3> psd_motion{};  ///< white, per unit of motion [m^2/m, m^2/m, rad^2/rad]
  std::array<double, 3> fraction{};    ///< constant over the segment, as a fraction of motion [-]
  double pose_std_xy = 0.0;            ///< of each measured pose, per axis [m]
  double pose_std_yaw = 0.0;           ///< of each measured pose [rad]
};
inline SLIPWISE_TUNING(kTurnRadius, 0.3);      ///< a turn of 1 rad slips the wheels like this distance [m]
inline SLIPWISE_TUNING(kStraightRadius, 5.0);  ///< driving this far disturbs the heading like a turn of 1 rad [m]

}  // namespace slipwise
