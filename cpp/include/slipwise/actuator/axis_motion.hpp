// SPDX-License-Identifier: Apache-2.0
// What one actuator axis does from a known state on, with exact derivatives (derivations/actuator.md).
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/actuator/input_history.hpp"

namespace slipwise {

/// One axis: which part of the inputs it follows, and how.
struct ActuatorAxis {
  double BodyTwist::* part;
  AxisResponse response;
  double delay;  ///< [s]
};

/// What the two modes of an axis hold; its speed is their sum [m/s or rad/s].
struct AxisState {
  double fast, slow;
};

/// Derivatives are by lag, delay [s], gain, slow fraction [-], slow lag [s], and by the fast and the slow state at the
/// start.
inline constexpr int kAxisParameters = 7;

struct AxisMotion {
  Eigen::VectorXd value;  ///< [K + 2] mean over each interval, then the state at the end
  Eigen::Matrix<double, Eigen::Dynamic, kAxisParameters> derivative;  ///< [K + 2, 7]
};

/// The state of an axis whose input at `time` [s] was held for long.
AxisState settled_axis(const InputHistory& inputs, const ActuatorAxis& axis, double time);

/// The axis over the K intervals between `edges` [s, increasing, in input stamps], from `start` at the first of them.
AxisMotion axis_motion(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
                       std::span<const double> edges);

/// Its values alone.
Eigen::VectorXd axis_values(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
                            std::span<const double> edges);

/// The speed of the axis at each of the `times` [s, increasing, in input stamps], as many as `speed` holds, from
/// `start` at the first of them.
void axis_speeds(const InputHistory& inputs, const ActuatorAxis& axis, const AxisState& start,
                 std::span<const double> times, std::span<double> speed);

}  // namespace slipwise
