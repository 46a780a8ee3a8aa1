// SPDX-License-Identifier: Apache-2.0
// From what a drive is told to how it moves, where it steers: lags act on speed and curvature, and the yaw rate follows
// behind them, V tan(delta) / L (derivations/actuator.md).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/input_history.hpp"
#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

inline constexpr double kShowsCurvature = 0.1;   ///< [m/s]; of a slower drive, a yaw rate does not tell the curvature
inline constexpr double kSharpestTangent = 2.0;  ///< of a steering angle; none turns wheels further

/// The sharpest curvature of a drive that steers [1/m].
inline double sharpest_curvature(double wheelbase) { return kSharpestTangent / wheelbase; }

/// Curvature that a twist asks of a drive that steers [1/m]; 0 at a standstill.
inline double curvature_of(const BodyTwist& twist, double wheelbase) {
  const double sharpest = sharpest_curvature(wheelbase);
  return twist.v == 0.0 ? 0.0 : std::clamp(twist.omega / twist.v, -sharpest, sharpest);
}

/// What the channels of a drive follow of a twist: where it steers, a curvature [1/m] in the place of the yaw rate.
inline BodyTwist channel_input(const BodyTwist& twist, double wheelbase) {
  if (!(wheelbase > 0.0)) {
    return twist;
  }
  return {
      .v = std::abs(twist.v) > kStandingSpeed ? twist.v : 0.0, .vy = twist.vy, .omega = curvature_of(twist, wheelbase)};
}

/// Whether a measured drive is fast enough to tell its curvature.
inline bool shows_curvature(const BodyTwist& drive) { return std::abs(drive.v) >= kShowsCurvature; }

/// Commands as the channels of a drive follow them.
InputHistory channel_inputs(const InputHistory& commands, double wheelbase);
/// The same of what was measured: while it is too slow to show its curvature, that of before holds.
InputHistory measured_channels(const InputHistory& measured, double wheelbase);

/// Makes a step's turn [rad] of the integral of its curvature. The derivatives, by parameters that move the duration
/// and the integrals, are the columns of `jacobian`.
template <typename Jacobian>
void steer(ActuatorStep& step, Jacobian& jacobian) {
  if (!(step.duration > 0.0)) {  // its integrals grow with the duration
    const double squared = jacobian.row(0).squaredNorm();
    jacobian.row(3) *= squared > 0.0 ? jacobian.row(1).dot(jacobian.row(0)) / squared : 0.0;
    step.turn = 0.0;
    return;
  }
  const double v = step.forward / step.duration, curvature = step.turn / step.duration;
  jacobian.row(3) = (v * jacobian.row(3) + curvature * jacobian.row(1) - v * curvature * jacobian.row(0)).eval();
  step.turn = v * step.turn;
}
inline void steer(ActuatorStep& step) {
  step.turn = step.duration > 0.0 ? step.forward / step.duration * step.turn : 0.0;
}

}  // namespace slipwise
