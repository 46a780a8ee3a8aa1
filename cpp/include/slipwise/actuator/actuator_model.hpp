// SPDX-License-Identifier: Apache-2.0
// From inputs to drive steps: clock offset, and per channel gain, transport delay and a lag of first or second order.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/lie/body_twist.hpp"

namespace slipwise {

/// Parameters of the actuator; the defaults are the identity. vy goes the way of v.
/// A channel's drive is gain * input, delayed; the fraction `slow_fraction` of it goes through the slow lag, the rest
/// through the lag. Two lags side by side are a second-order response: what a velocity controller with an integral part
/// does. Where the drive steers, all of the yaw rate's is of the curvature of the path in its place, and the yaw rate
/// follows behind the lags (kinematics.hpp).
struct ActuatorModel {
  double time_constant_v = 0.0;           ///< time constant of the speed [s]
  double time_constant_omega = 0.0;       ///< time constant of the yaw rate [s]
  double delay_v = 0.0;                   ///< transport delay of the speed [s]
  double delay_omega = 0.0;               ///< transport delay of the yaw rate [s]
  double clock_offset = 0.0;              ///< poses are stamped this much later than the inputs [s]
  double gain_v = 1.0;                    ///< of the speed [-]
  double gain_omega = 1.0;                ///< of the yaw rate [-]
  double slow_fraction_v = 0.0;           ///< of the speed [-]
  double slow_fraction_omega = 0.0;       ///< of the yaw rate [-]
  double slow_time_constant_v = 0.0;      ///< slow time constant of the speed [s]; without one there is no slow mode
  double slow_time_constant_omega = 0.0;  ///< slow time constant of the yaw rate [s]
  double wheelbase = 0.0;                 ///< of a drive that steers [m], which is no parameter; 0 where it does not
  bool follows_wheels = false;            ///< no parameter: inputs did the same before the first that was measured
};
inline constexpr Eigen::Index kActuatorParameters = 11;  ///< the fields above in their order, but for the last two
inline constexpr Eigen::Index kDelayV = 2, kDelayOmega = 3, kClockOffset = 4;  ///< places among them

/// What was measured of the drive: its twist until a moment in input stamps, such as wheel speeds until now.
struct MeasuredActuator {
  std::shared_ptr<const InputHistory> twist;  ///< measured, held between samples
  double until;                               ///< [s] in input stamps; nothing later is used
  bool any_inputs = false;  ///< any inputs may follow, not only those that the drive was given: none overspeeds it
};

/// A stretch of time, in pose stamps, and the drive's state at its start.
struct ActuatorSpan {
  double start;                                ///< [s]
  double end;                                  ///< [s]; inputs later than this are not used, but `ahead`
  std::optional<BodyTwist> initial = {};       ///< the drive's twist, where it was measured: at the start, or
  std::optional<MeasuredActuator> known = {};  ///< where the drive is known until some moment, at that moment
  double longest_step = 0.1;                   ///< [s]; a lagging twist is averaged over no more than this
  double ahead = 0.0;                          ///< [s] after the end in which inputs drive what is stamped early
};

/// One step of constant mean twist: its duration and its integrals.
struct ActuatorStep {
  double duration;  ///< [s]
  double forward;   ///< integral of v [m]
  double left;      ///< integral of vy [m]
  double turn;      ///< integral of omega [rad]
};
/// Derivatives of (duration, forward, left, turn) by the actuator's parameters.
using ActuatorStepJacobian = Eigen::Matrix<double, 4, kActuatorParameters>;

struct ActuatorSteps {
  std::vector<ActuatorStep> steps;
  std::vector<ActuatorStepJacobian> jacobians;  ///< empty unless asked for
};

/// The drive over [start - clock_offset, end - clock_offset] of the inputs, split wherever a delayed input changes.
/// Its known state was measured; after that the actuator goes on from `initial`.
ActuatorSteps actuator_steps(const InputHistory& inputs, const ActuatorModel& actuator, const ActuatorSpan& window);
/// The same with exact sensitivities to the actuator's parameters.
ActuatorSteps linearize_actuator_steps(const InputHistory& inputs, const ActuatorModel& actuator,
                                       const ActuatorSpan& window);

}  // namespace slipwise
