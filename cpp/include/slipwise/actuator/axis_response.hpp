// SPDX-License-Identifier: Apache-2.0
// How one channel of the drive answers its delayed input: two lags side by side, behind a gain
// (derivations/actuator.md).
#pragma once

#include <algorithm>

#include "slipwise/actuator/actuator_model.hpp"

namespace slipwise {

struct AxisResponse {
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

inline AxisResponse speed_response(const ActuatorModel& actuator) {
  return {actuator.gain_v, actuator.lag_v, actuator.slow_share_v, actuator.slow_lag_v};
}
inline AxisResponse yaw_rate_response(const ActuatorModel& actuator) {
  return {actuator.gain_omega, actuator.lag_omega, actuator.slow_share_omega, actuator.slow_lag_omega};
}

inline constexpr double kSettledLags = 8.0;  ///< after this many time constants the start of a lag is forgotten (e^-8)

/// For how long before a moment at which the whole drive is known the inputs must be followed, so that it is known how
/// it is divided between the fast and the slow mode [s].
inline double parts_warm_up(const AxisResponse& speed, const AxisResponse& turn) {
  return kSettledLags *
         std::max(speed.has_slow_part() ? speed.longest_lag() : 0.0, turn.has_slow_part() ? turn.longest_lag() : 0.0);
}

}  // namespace slipwise
