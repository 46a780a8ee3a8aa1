// SPDX-License-Identifier: Apache-2.0
// What is in a drive where a rollout starts: of its twist, what each of the two lags holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/actuator/slow_mode.hpp"
#include "slipwise/rollout/actuator_schedule.hpp"

namespace slipwise {

/// One channel of a drive.
struct ActuatorStart {
  double commanded;  ///< the input that keeps the drive as it is, for when no command was sent yet
  double fast;       ///< what the fast lag holds
  double slow;       ///< what the slow lag holds
};

/// When the command that is sent at i * period acts [s].
inline double acts_at(const ChannelTiming& channel, double period, std::ptrdiff_t i) {
  return static_cast<double>(i + channel.shift) * period + channel.rest;
}

/// The inputs of a channel until the start: `command(i)` is the one sent at i * period, of which those before `oldest`
/// equal the oldest; without any sent before the start (`oldest` is 0), they are `keeping`.
template <typename Command>
struct StartInputs {
  const ChannelTiming& channel;
  double period;
  std::ptrdiff_t oldest;
  double keeping;
  const Command& command;

  double at(std::ptrdiff_t i) const { return oldest == 0 && i < 0 ? keeping : command(std::max(i, oldest)); }

  /// What acts at the start.
  double now() const { return at(static_cast<std::ptrdiff_t>(std::floor(-channel.rest / period)) - channel.shift); }

  /// A lag's output at the start, after inputs that began `warm_up` seconds before it.
  double lagged(double lag, double warm_up) const {
    const auto begun = static_cast<std::ptrdiff_t>(std::floor((-warm_up - channel.rest) / period)) - channel.shift;
    std::ptrdiff_t i = std::max(begun, oldest - 1);
    double output = at(i);
    for (double time = std::max(-warm_up, acts_at(channel, period, i)); time < 0.0; ++i) {
      const double next = std::min(acts_at(channel, period, i + 1), 0.0);
      output = lag_output(output, at(i), lag, next - time);
      time = next;
    }
    return output;
  }
};

/// The whole drive was measured; what the commands before it say of its parts, as slow_mode.hpp has it. Without any the
/// drive is settled.
template <typename Command>
ActuatorStart actuator_start(const ActuatorSchedule& actuator, const ChannelTiming& channel, double drive,
                             std::ptrdiff_t oldest, const Command& command) {
  const AxisResponse& response = channel.response;
  const double keeping = response.keeping_input(drive);
  if (!response.has_slow_mode()) {
    return {.commanded = keeping, .fast = drive, .slow = 0.0};
  }
  if (oldest == 0 && acts_at(channel, actuator.period, oldest) > 0.0) {
    return {.commanded = keeping, .fast = (1.0 - response.fraction()) * drive, .slow = response.fraction() * drive};
  }
  const double warm_up = parts_warm_up(actuator.v.response, actuator.omega.response);
  const StartInputs<Command> inputs{channel, actuator.period, oldest, keeping, command};
  const double fraction = response.fraction();
  const MeasuredChannel<double> measured{
      .left = drive - response.fast_fraction() * inputs.lagged(response.time_constant, warm_up),
      .modelled = fraction * response.gain * inputs.lagged(response.slow_time_constant, warm_up),
      .settled = fraction * response.gain * inputs.now(),
      .bound = fraction * drive};
  const double slow = slow_mode(measured);
  return {.commanded = keeping, .fast = drive - slow, .slow = slow};
}

/// Nothing was measured of the channel: it has followed the commands before it, from rest.
template <typename Command>
ActuatorStart followed_start(const ActuatorSchedule& actuator, const ChannelTiming& channel, std::ptrdiff_t oldest,
                             const Command& command) {
  const AxisResponse& response = channel.response;
  const double warm_up = kSettledLags * response.longest_lag();
  const StartInputs<Command> inputs{channel, actuator.period, oldest, 0.0, command};
  const double slow = response.gain * response.fraction();
  return {.commanded = 0.0,
          .fast = response.fast_fraction() * inputs.lagged(response.time_constant, warm_up),
          .slow = slow != 0.0 ? slow * inputs.lagged(response.slow_time_constant, warm_up) : 0.0};
}

}  // namespace slipwise
