// SPDX-License-Identifier: Apache-2.0
// What the ground under a segment is known to be: an attitude measured along it, a constant grade, or a map of
// elevations (derivations/slopes-and-forces.md).
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/elevation_map.hpp"

namespace slipwise {

/// Roll and pitch at a stamp; by REP-103 nose down is positive pitch.
struct Tilt {
  double t;      ///< [s]
  double roll;   ///< [rad]
  double pitch;  ///< [rad]
};

/// The robot's attitude as it was measured: interpolated, and held before the first and after the last.
struct MeasuredTilts {
  std::vector<Tilt> at;  ///< in order of their stamps; level ground where there are none
};

/// A plane: how much it rises per metre along the axes of the frame of the path's first pose, whose z axis is vertical.
struct Grade {
  double rise_x = 0.0;  ///< [m/m]
  double rise_y = 0.0;  ///< [m/m]
};

/// A map of elevations, and the path's first pose on it.
struct MappedGround {
  std::shared_ptr<const ElevationMap> map;
  Pose2 start = {};
};

using Ground = std::variant<MeasuredTilts, Grade, MappedGround>;

/// The plane on which a robot that looks along x has this attitude.
Grade grade_of(const Tilt& tilt);
/// The attitude between the stamps that were measured.
Tilt tilt_between(const MeasuredTilts& measured, double t);

/// How high and how tilted a robot stands at a pose.
struct Standing {
  double z = 0.0;      ///< [m] above where the path begins
  double roll = 0.0;   ///< [rad]
  double pitch = 0.0;  ///< [rad]
};
/// On a plane or a map; `pose` is seen from the path's first.
/// \throws std::invalid_argument for a measured attitude, which tells no height.
Standing standing_at(const Ground& ground, const Pose2& pose);

}  // namespace slipwise
