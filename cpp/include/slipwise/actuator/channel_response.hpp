// SPDX-License-Identifier: Apache-2.0
// How one channel of the drive answers its delayed input: two lags side by side, behind a gain (derivations.md, section
// 4).
#pragma once

#include <algorithm>

#include "slipwise/actuator/command_chain.hpp"

namespace slipwise {

struct ChannelResponse {
  double gain, lag, slow_share, slow_lag;

  bool has_slow_part() const { return slow_lag > 0.0; }
  /// Of the input, what goes through the slow lag.
  double share() const { return has_slow_part() ? slow_share : 0.0; }
  /// Of the input, what the fast lag goes towards.
  double fast_share() const { return (1.0 - share()) * gain; }
  double longest_lag() const { return std::max(lag, slow_lag); }
  /// The input that keeps a channel at `drive`.
  double keeping_input(double drive) const { return gain != 0.0 ? drive / gain : 0.0; }
};

inline ChannelResponse speed_response(const CommandChain& chain) {
  return {chain.gain_v, chain.lag_v, chain.slow_share_v, chain.slow_lag_v};
}
inline ChannelResponse turn_response(const CommandChain& chain) {
  return {chain.gain_omega, chain.lag_omega, chain.slow_share_omega, chain.slow_lag_omega};
}

inline constexpr double kSettledLags = 8.0;  ///< after this many time constants the start of a lag is forgotten (e^-8)

/// For how long before a moment at which the whole drive is known the inputs must be followed, so that it is known how
/// it is divided between the fast and the slow mode [s].
inline double parts_warm_up(const ChannelResponse& speed, const ChannelResponse& turn) {
  return kSettledLags *
         std::max(speed.has_slow_part() ? speed.longest_lag() : 0.0, turn.has_slow_part() ? turn.longest_lag() : 0.0);
}

}  // namespace slipwise
