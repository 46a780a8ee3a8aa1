// SPDX-License-Identifier: Apache-2.0
// How one channel of the drive answers its delayed input: two lags side by side, behind a gain
// (derivations/actuator.md).
#pragma once

#include <algorithm>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/linear/plain_value.hpp"

namespace slipwise {

/// `T` is a number, or one with derivatives by the actuator's parameters.
template <typename T>
struct AxisResponseOf {
  T gain, time_constant, slow_fraction, slow_time_constant;

  bool has_slow_mode() const { return value_of(slow_time_constant) > 0.0; }
  /// Of the input, what goes through the slow lag.
  T fraction() const { return has_slow_mode() ? slow_fraction : T(0.0); }
  /// Of the input, what the fast lag goes towards.
  T fast_fraction() const { return (1.0 - fraction()) * gain; }
  double longest_lag() const { return std::max(value_of(time_constant), value_of(slow_time_constant)); }
  /// The input that keeps a channel at `drive`.
  T keeping_input(double drive) const { return value_of(gain) != 0.0 ? drive / gain : T(0.0); }
};
using AxisResponse = AxisResponseOf<double>;

inline AxisResponse speed_response(const ActuatorModel& actuator) {
  return {actuator.gain_v, actuator.time_constant_v, actuator.slow_fraction_v, actuator.slow_time_constant_v};
}
inline AxisResponse yaw_rate_response(const ActuatorModel& actuator) {
  return {actuator.gain_omega, actuator.time_constant_omega, actuator.slow_fraction_omega,
          actuator.slow_time_constant_omega};
}

inline constexpr double kSettledLags = 8.0;  ///< after this many time constants the start of a lag is forgotten (e^-8)

/// For how long before a moment at which the whole drive is known the inputs must be followed, so that it is known how
/// it is divided between the fast and the slow mode [s].
template <typename T>
double parts_warm_up(const AxisResponseOf<T>& speed, const AxisResponseOf<T>& turn) {
  return kSettledLags *
         std::max(speed.has_slow_mode() ? speed.longest_lag() : 0.0, turn.has_slow_mode() ? turn.longest_lag() : 0.0);
}

}  // namespace slipwise
