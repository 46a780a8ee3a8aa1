// SPDX-License-Identifier: Apache-2.0
// One walk per axis.
#include "slipwise/actuator/actuator_output.hpp"

namespace slipwise {

ActuatorAxis speed_axis(const ActuatorModel& actuator) {
  return {&BodyTwist::v,
          {.gain = actuator.gain_v,
           .time_constant = actuator.time_constant_v,
           .slow_fraction = 0.0,
           .slow_time_constant = 0.0},
          actuator.delay_v};
}

ActuatorAxis yaw_rate_axis(const ActuatorModel& actuator) {
  return {&BodyTwist::omega,
          {.gain = actuator.gain_omega,
           .time_constant = actuator.time_constant_omega,
           .slow_fraction = 0.0,
           .slow_time_constant = 0.0},
          actuator.delay_omega};
}

ActuatorOutput actuator_output(const InputHistory& inputs, const ActuatorModel& actuator, std::span<const double> times,
                               const BodyTwist& initial) {
  ActuatorOutput output{.v = std::vector<double>(times.size()), .omega = std::vector<double>(times.size())};
  axis_speeds(inputs, speed_axis(actuator), {.fast = initial.v, .slow = 0.0}, times, output.v);
  axis_speeds(inputs, yaw_rate_axis(actuator), {.fast = initial.omega, .slow = 0.0}, times, output.omega);
  return output;
}

}  // namespace slipwise
