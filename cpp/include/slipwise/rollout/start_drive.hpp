// SPDX-License-Identifier: Apache-2.0
// What is in a drive where a rollout starts: of its twist, what each of the two lags holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/rollout/chain_schedule.hpp"

namespace slipwise {

/// One channel of a drive.
struct StartDrive {
  double told;  ///< the input that would keep the drive as it is, for when no command was sent yet
  double fast;  ///< what the fast lag holds
  double slow;  ///< what the slow lag holds
};

/// The input that would keep a channel as it is.
inline double told_by(const ChannelResponse& response, double drive) {
  return response.gain != 0.0 ? drive / response.gain : 0.0;
}

/// A lag's output at the start, after inputs that began `warm_up` seconds before it. `command(i)` is the one sent at
/// i * period, of which those before `oldest` equal the oldest.
template <typename Command>
double lagged_input(const ChannelTiming& channel, double period, double warm_up, std::ptrdiff_t oldest,
                    const Command& command) {
  const auto acts = [&](std::ptrdiff_t i) { return static_cast<double>(i + channel.shift) * period + channel.rest; };
  const auto begun = static_cast<std::ptrdiff_t>(std::floor((-warm_up - channel.rest) / period)) - channel.shift;
  std::ptrdiff_t i = std::max(begun, oldest);
  double output = command(i);
  for (double now = std::max(-warm_up, acts(i)); now < 0.0; ++i) {
    const double next = std::min(acts(i + 1), 0.0);
    output = lag_step(output, command(i), channel.response.lag, next - now).output;
    now = next;
  }
  return output;
}

/// The whole drive was measured: what the fast part does not explain is the slow part's. Without any command sent
/// before the start (`oldest` is 0) the drive is taken to be settled.
template <typename Command>
StartDrive start_drive(const ChainSchedule& chain, const ChannelTiming& channel, double drive, std::ptrdiff_t oldest,
                       const Command& command) {
  const ChannelResponse& response = channel.response;
  StartDrive start{.told = told_by(response, drive), .fast = drive, .slow = 0.0};
  if (response.has_slow_part()) {
    const double warm_up = fast_warm_up(chain.v.response, chain.omega.response);
    const auto sent = [&](std::ptrdiff_t i) { return i < 0 && oldest == 0 ? start.told : command(i); };
    start.fast = response.fast_share() *
                 lagged_input(channel, chain.period, warm_up, std::min<std::ptrdiff_t>(oldest, -1), sent);
    start.slow = drive - start.fast;
  }
  return start;
}

}  // namespace slipwise
