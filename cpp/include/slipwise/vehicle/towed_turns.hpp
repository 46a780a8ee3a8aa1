// SPDX-License-Identifier: Apache-2.0
// How trailers turn behind a robot that is known by its steps.
#pragma once

#include <Eigen/Core>
#include <span>

namespace slipwise {

/// A trailer on a hitch behind the axle of a robot.
struct Trailer {
  double length;  ///< from the hitch to the axle [m], above 0
  double turn;    ///< of the robot's turns, the fraction that it makes
  double behind;  ///< from the robot's axle to the hitch, in lengths
};

/// Returns the turns [rad] of trailers in each of K steps, [K, trailers]: L psi' = v sin(phi) - b omega cos(phi) with
/// the fold phi, which is 0 before the first step and at most `most_folded` [rad]. `forward` [m] and `rotation` [rad]
/// are the robot's, [K] both; each step is taken in `parts`, at least 1. Throws std::invalid_argument for a length of
/// 0, a fold below 0, no part, or another number of turns than of ways.
Eigen::MatrixXd towed_turns(const Eigen::Ref<const Eigen::VectorXd>& forward,
                            const Eigen::Ref<const Eigen::VectorXd>& rotation, std::span<const Trailer> trailers,
                            double most_folded, int parts);

}  // namespace slipwise
