// SPDX-License-Identifier: Apache-2.0
// The drive's speed and yaw rate at given moments, as wheel speeds measure them.
#pragma once

#include <span>
#include <vector>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/axis_motion.hpp"
#include "slipwise/actuator/input_history.hpp"

namespace slipwise {

/// An axis of the actuator, without its slow mode.
ActuatorAxis speed_axis(const ActuatorModel& actuator);
ActuatorAxis yaw_rate_axis(const ActuatorModel& actuator);

/// Speed [m/s] and yaw rate [rad/s] at each of the `times`. A slow mode is not followed.
struct ActuatorOutput {
  std::vector<double> v, omega;
};
/// Times are increasing, in input stamps [s]; at the first of them the drive does `initial`.
ActuatorOutput actuator_output(const InputHistory& inputs, const ActuatorModel& actuator, std::span<const double> times,
                               const BodyTwist& initial);

}  // namespace slipwise
