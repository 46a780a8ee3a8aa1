// SPDX-License-Identifier: Apache-2.0
// What is tried of a car: curves straight between knots, lags, and delays of its commands (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <iterator>

#include "slipwise/actuator/car_curves.hpp"
#include "slipwise/identify/curve_bank.hpp"

namespace slipwise {

inline constexpr std::array kCarThrottle{0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.8, 1.0};
inline constexpr std::array kCarSteering{0.0, 0.2, 0.4, 0.6, 0.8, 1.0};
inline constexpr std::array kCarLags{0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45,
                                     0.5, 0.6,  0.7, 0.8,  0.9, 1.0,  1.2, 1.5,  2.0};                     // [s]
inline constexpr std::array kCarSteeringLags{0.0, 0.025, 0.05, 0.075, 0.1, 0.125, 0.15, 0.2, 0.25, 0.35};  // [s]
inline constexpr std::array kCarDelays{0.0, 0.05, 0.1, 0.15, 0.2, 0.3};                                    // [s]
inline constexpr Eigen::Index kThrottleRamps = 2 * (std::ssize(kCarThrottle) - 1);
inline constexpr Eigen::Index kSteeringRamps = 2 * (std::ssize(kCarSteering) - 1);

/// How far a throttle or a steering is up each ramp between knots on its own side of zero; on the other side ramps go
/// down.
Eigen::VectorXd throttle_ramps(double throttle);
Eigen::VectorXd steering_ramps(double steering);

/// All lags of one delay, then those of the next: their features are the lagging ramps and the drag of cornering.
CurveBank car_speed_bank(double top_speed, double noise);
/// The same of the steering: a curvature straight ahead, the ramps and the understeer.
CurveBank car_turn_bank(double curvature, double noise);

/// The car of the most likely candidates; throttle and steering have one delay.
CarCurves car_of_candidates(const CurveBank& speed, const CurveBank& turn);

}  // namespace slipwise
