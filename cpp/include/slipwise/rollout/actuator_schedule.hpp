// SPDX-License-Identifier: Apache-2.0
// The command actuator over one control period: when the next command begins to act, and how the lags close meanwhile.
#pragma once

#include <cstddef>
#include <vector>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/linear/dual_number.hpp"
#include "slipwise/motion/motion_model.hpp"

namespace slipwise {

/// Numbers here are of a type `T`: a double, or one with derivatives by the actuator's parameters.
///
/// How a lag moves over a part: with gap = output - input, the mean output is input + gap * mean_gap, and the output at
/// the end is input + gap * end_gap. Both are 0 without lag.
template <typename T>
struct LagFractionOf {
  T mean_gap;
  T end_gap;
};

/// The two lags of a channel over a part.
template <typename T>
struct ChannelFractionOf {
  LagFractionOf<T> fast;
  LagFractionOf<T> slow;
};

/// A stretch of time over which the delayed commands are constant.
template <typename T>
struct PeriodPartOf {
  T duration;       ///< [s]
  bool next_v;      ///< the next command's speed begins to act where this part begins
  bool next_omega;  ///< the same for the yaw rate
  ChannelFractionOf<T> v;
  ChannelFractionOf<T> omega;
};

/// When a channel's commands begin to act, and how it answers them: command i is sent at i * period and acts at
/// (i + shift) * period + rest.
template <typename T>
struct ChannelTimingOf {
  std::ptrdiff_t shift;  ///< whole periods of delay; negative where the clock offset makes commands act early
  T rest;                ///< [s], less than a period
  AxisResponseOf<T> response;
};

/// What every control period of a rollout looks like. Command i is sent at i * period and held. Steps end where
/// commands begin to act, as those of actuator_steps do, so a cycle runs from such a moment to the same one a period
/// later; the pose at the period's end lies within its last stretch.
template <typename T>
struct ActuatorScheduleOf {
  double period;  ///< [s]
  ChannelTimingOf<T> v;
  ChannelTimingOf<T> omega;
  bool lags;                             ///< some channel lags
  bool responds;                         ///< some channel has a gain or a slow mode
  std::vector<PeriodPartOf<T>> lead_in;  ///< from the start to the first cycle
  std::vector<PeriodPartOf<T>> cycle;
  std::size_t branch;                 ///< the part of the cycle in place of which the tail leads to the period's end
  std::vector<PeriodPartOf<T>> tail;  ///< empty where the cycle ends with the period
  double wheelbase = 0.0;  ///< of a drive that steers [m]: `omega` is the channel of its curvature; 0: it does not
};

using PeriodPart = PeriodPartOf<double>;
using ChannelTiming = ChannelTimingOf<double>;
using ActuatorSchedule = ActuatorScheduleOf<double>;

/// A number with its derivatives by the actuator's parameters, as many of them as a model may learn.
using ActuatorDual = Dual<double, static_cast<int>(kActuatorParameters)>;

/// What a schedule is made of. `T` is a number, or an ActuatorDual.
template <typename T>
struct ActuatorNumbers {
  AxisResponseOf<T> v, omega;
  T delay_v, delay_omega;  ///< [s], with the clock offset
  double wheelbase;        ///< [m], of a drive that steers
};

/// The actuator's numbers, with derivatives by the model's actuator parameters in their order.
ActuatorNumbers<ActuatorDual> differentiable_numbers(const MotionModel& model,
                                                     const Eigen::Ref<const Eigen::VectorXd>& parameters);

/// The same steps that actuator_steps takes for commands sent every `period` seconds.
/// \throws std::invalid_argument when the period is not positive and finite or the actuator is longer than 1e6 periods.
template <typename T>
ActuatorScheduleOf<T> schedule_actuator(const ActuatorNumbers<T>& actuator, double period);
ActuatorSchedule schedule_actuator(const ActuatorModel& actuator, double period);

}  // namespace slipwise
