// SPDX-License-Identifier: Apache-2.0
// A trailer behind a vehicle: how its hitch angle moves, exactly linearised (derivations/trailer.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"

namespace slipwise {

/// A trailer of one axle. Its wheels do not slide across, but for what `length` then says.
struct Trailer {
  double length;        ///< from the hitch back to the trailer's axle [m]
  double hitch_offset;  ///< from base_link back to the hitch [m]; negative where it lies ahead
};

/// Rate of the hitch angle `psi` (heading of the trailer less that of the vehicle, to the left) [rad/s]:
/// psi' = -omega - ((V sin psi - Vy cos psi) + hitch_offset omega cos psi) / length.
double hitch_rate(const Trailer& trailer, double psi, const BodyTwist& twist);

/// The hitch angle after a twist was held.
struct HitchStep {
  double psi = 0.0;                                    ///< [rad]
  Eigen::RowVector3d by = Eigen::RowVector3d::Zero();  ///< by psi at the start, length and hitch offset
};
/// Runge-Kutta of fourth order in steps of no more than a fiftieth of a second.
/// \throws std::invalid_argument when the length is not positive, or the duration is negative.
HitchStep hitch_after(const Trailer& trailer, double psi, const BodyTwist& twist, double duration);

/// The pose of the trailer's axle, seen from where that of the vehicle's base_link is seen from.
Pose2 trailer_pose(const Trailer& trailer, const Pose2& vehicle, double psi);

}  // namespace slipwise
