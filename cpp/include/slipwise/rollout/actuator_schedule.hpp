// SPDX-License-Identifier: Apache-2.0
// The command actuator over one control period: when the next command begins to act, and how the lags close meanwhile.
#pragma once

#include <cstddef>
#include <vector>

#include "slipwise/actuator/axis_response.hpp"

namespace slipwise {

/// How a lag moves over a part: with gap = output - input, the mean output is input + gap * mean_gap, and the output at
/// the end is input + gap * end_gap. Both are 0 without lag.
struct LagFraction {
  double mean_gap;
  double end_gap;
};

/// The two lags of a channel over a part.
struct ChannelFraction {
  LagFraction fast;
  LagFraction slow;
};

/// A stretch of time over which the delayed commands are constant.
struct PeriodPart {
  double duration;  ///< [s]
  bool next_v;      ///< the next command's speed begins to act where this part begins
  bool next_omega;  ///< the same for the yaw rate
  ChannelFraction v;
  ChannelFraction omega;
};

/// When a channel's commands begin to act, and how it answers them: command i is sent at i * period and acts at
/// (i + shift) * period + rest.
struct ChannelTiming {
  std::ptrdiff_t shift;  ///< whole periods of delay; negative where the clock offset makes commands act early
  double rest;           ///< [s], less than a period
  AxisResponse response;
};

/// What every control period of a rollout looks like. Command i is sent at i * period and held. Steps end where
/// commands begin to act, as those of actuator_steps do, so a cycle runs from such a moment to the same one a period
/// later; the pose at the period's end lies within its last stretch.
struct ActuatorSchedule {
  double period;  ///< [s]
  ChannelTiming v;
  ChannelTiming omega;
  bool lags;                        ///< some channel lags
  bool responds;                    ///< some channel has a gain or a slow mode
  std::vector<PeriodPart> lead_in;  ///< from the start to the first cycle
  std::vector<PeriodPart> cycle;
  std::size_t branch;            ///< the part of the cycle in place of which the tail leads to the period's end
  std::vector<PeriodPart> tail;  ///< empty where the cycle ends with the period
  double wheelbase = 0.0;  ///< of a drive that steers [m]: `omega` is the channel of its curvature; 0: it does not
};

/// The same steps that actuator_steps takes for commands sent every `period` seconds.
/// \throws std::invalid_argument when the period is not positive and finite or the actuator is longer than 1e6 periods.
ActuatorSchedule schedule_actuator(const ActuatorModel& actuator, double period);

}  // namespace slipwise
