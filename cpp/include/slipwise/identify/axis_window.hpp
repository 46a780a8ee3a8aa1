// SPDX-License-Identifier: Apache-2.0
// One axis of the drive over a window of wheel speeds: its state at first, and how its means and its end
// follow from the actuator and from its state at the start (derivations/actuator.md).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slipwise/actuator/axis_motion.hpp"
#include "slipwise/identify/actuator_noise.hpp"
#include "slipwise/identify/wheel_means.hpp"

namespace slipwise {

/// Log lag, log delay [ln s], gain, slow fraction [-], log slow lag [ln s].
inline constexpr int kChannelParameters = 5;
inline constexpr Eigen::Index kTimeConstant = 0, kDelay = 1, kSlowFraction = 3, kSlowTimeConstant = 4;  ///< places
/// Fast part, slow mode, deviation from the actuator.
inline constexpr int kAxisStates = 3;

using ChannelParameters = Eigen::Matrix<double, kChannelParameters, 1>;
using AxisVector = Eigen::Matrix<double, kAxisStates, 1>;

/// A window of wheel speeds and the inputs that they follow.
struct ChannelWindow {
  InputHistory inputs;
  WheelMeans observed;
};

/// The axis that follows this part of the inputs through a channel's parameters.
ActuatorAxis axis_of(double BodyTwist::* part, const ChannelParameters& parameters);

/// An axis's state and the variances of its parts.
struct FirstAxisState {
  AxisVector mean, variance;
};

/// Of an axis that was not followed until the window only the range of its speeds is known; none where it does not
/// move. `deviation` is the variance of its deviation.
std::optional<FirstAxisState> first_state(const ChannelWindow& window, const ActuatorAxis& axis, double deviation);

/// The axis through the window from the fast and the slow mode at its start; derivatives by lags and delay are by their
/// logarithms, as the channel's parameters are.
AxisMotion axis_through(const ChannelWindow& window, const ActuatorAxis& axis, const AxisState& start);

/// The K means of the window, and after them the state at its end.
struct AxisWindow {
  Eigen::VectorXd value;                                                  ///< [K + 3]
  Eigen::Matrix<double, Eigen::Dynamic, kChannelParameters> by_actuator;  ///< [K + 3, 5] by the channel's parameters
  Eigen::Matrix<double, Eigen::Dynamic, kAxisStates> by_state;            ///< [K + 3, 3] by the state at the start
};

AxisWindow axis_window(const ChannelWindow& window, const ActuatorAxis& axis, const AxisVector& start,
                       const ActuatorNoiseMeans& noise);

/// What wheel speeds say of the axis, [K].
Eigen::VectorXd axis_means(const WheelMeans& observed, const ActuatorAxis& axis);

}  // namespace slipwise
