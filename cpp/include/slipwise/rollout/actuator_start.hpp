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

/// One channel of a drive. `T` is a number, or one with derivatives by the actuator's parameters.
template <typename T>
struct ActuatorStartOf {
  T commanded;  ///< the input that keeps the drive as it is, for when no command was sent yet
  T fast;       ///< what the fast lag holds
  T slow;       ///< what the slow lag holds
};
using ActuatorStart = ActuatorStartOf<double>;

/// When the command that is sent at i * period acts [s].
template <typename T>
T acts_at(const ChannelTimingOf<T>& channel, double period, std::ptrdiff_t i) {
  return static_cast<double>(i + channel.shift) * period + channel.rest;
}

/// The inputs of a channel until the start: `command(i)` is the one sent at i * period, of which those before `oldest`
/// equal the oldest; without any sent before the start (`oldest` is 0), they are `keeping`.
template <typename T, typename Command>
struct StartInputs {
  const ChannelTimingOf<T>& channel;
  double period;
  std::ptrdiff_t oldest;
  T keeping;
  const Command& command;

  T at(std::ptrdiff_t i) const { return oldest == 0 && i < 0 ? keeping : T(command(std::max(i, oldest))); }

  /// What acts at the start.
  T now() const { return at(periods_to(0.0)); }

  /// A lag's output at the start, after inputs that began `warm_up` seconds before it.
  T lagged(const T& lag, double warm_up) const {
    const auto by_value = [](const T& a, const T& b) { return value_of(a) < value_of(b); };
    std::ptrdiff_t i = std::max(periods_to(-warm_up), oldest - 1);
    T output = at(i);
    for (T time = std::max(T(-warm_up), acts_at(channel, period, i), by_value); value_of(time) < 0.0; ++i) {
      const T next = std::min(acts_at(channel, period, i + 1), T(0.0), by_value);
      output = lag_output(output, at(i), lag, T(next - time));
      time = next;
    }
    return output;
  }

 private:
  /// The command that acts at a time.
  std::ptrdiff_t periods_to(double time) const {
    return static_cast<std::ptrdiff_t>(std::floor((time - value_of(channel.rest)) / period)) - channel.shift;
  }
};

/// The whole drive was measured; what the commands before it say of its parts, as slow_mode.hpp has it. Without any the
/// drive is settled.
template <typename T, typename Command>
ActuatorStartOf<T> actuator_start(const ActuatorScheduleOf<T>& actuator, const ChannelTimingOf<T>& channel,
                                  double drive, std::ptrdiff_t oldest, const Command& command) {
  const AxisResponseOf<T>& response = channel.response;
  const T keeping = response.keeping_input(drive);
  if (!response.has_slow_mode()) {
    return {.commanded = keeping, .fast = T(drive), .slow = T(0.0)};
  }
  if (oldest == 0 && value_of(acts_at(channel, actuator.period, oldest)) > 0.0) {
    return {.commanded = keeping, .fast = (1.0 - response.fraction()) * drive, .slow = response.fraction() * drive};
  }
  const double warm_up = parts_warm_up(actuator.v.response, actuator.omega.response);
  const StartInputs<T, Command> inputs{channel, actuator.period, oldest, keeping, command};
  const T fraction = response.fraction();
  const MeasuredChannel<T> measured{
      .left = drive - response.fast_fraction() * inputs.lagged(response.time_constant, warm_up),
      .modelled = fraction * response.gain * inputs.lagged(response.slow_time_constant, warm_up),
      .settled = fraction * response.gain * inputs.now(),
      .bound = fraction * drive};
  const T slow = slow_mode(measured);
  return {.commanded = keeping, .fast = drive - slow, .slow = slow};
}

/// Nothing was measured of the channel: it has followed the commands before it, from rest.
template <typename T, typename Command>
ActuatorStartOf<T> followed_start(const ActuatorScheduleOf<T>& actuator, const ChannelTimingOf<T>& channel,
                                  std::ptrdiff_t oldest, const Command& command) {
  const AxisResponseOf<T>& response = channel.response;
  const double warm_up = kSettledLags * response.longest_lag();
  const StartInputs<T, Command> inputs{channel, actuator.period, oldest, T(0.0), command};
  const T slow = response.gain * response.fraction();
  return {.commanded = T(0.0),
          .fast = response.fast_fraction() * inputs.lagged(response.time_constant, warm_up),
          .slow = response.has_slow_mode() ? slow * inputs.lagged(response.slow_time_constant, warm_up) : T(0.0)};
}

}  // namespace slipwise
