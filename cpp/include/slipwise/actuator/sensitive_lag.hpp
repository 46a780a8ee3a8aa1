// SPDX-License-Identifier: Apache-2.0
// A lag's output together with its derivatives, carried from step to step (derivations.md, section 4).
#pragma once

#include <Eigen/Core>

#include "slipwise/actuator/channel_response.hpp"
#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {

/// A value with its derivatives by N parameters; by none, the value alone.
template <int N>
struct Sensitive {
  double value = 0.0;
  Eigen::Matrix<double, 1, N> slope = Eigen::Matrix<double, 1, N>::Zero();
};

template <int N>
double value_of(const Sensitive<N>& number) {
  return number.value;
}

/// Where a channel's parameters stand among the N.
struct ChannelPlaces {
  Eigen::Index lag, delay, gain, slow_share, slow_lag;
};

/// The part of an input that one of a channel's two lags follows: share * gain * input.
template <int N>
Sensitive<N> part_of(double input, const ChannelResponse& response, const ChannelPlaces& places, bool slow) {
  const double share = slow ? response.share() : 1.0 - response.share();
  Sensitive<N> part{.value = share * response.gain * input};
  if constexpr (N > 0) {
    part.slope[places.gain] = share * input;
    if (response.has_slow_part()) {
      part.slope[places.slow_share] = (slow ? 1.0 : -1.0) * response.gain * input;
    }
  }
  return part;
}

/// Moves one lag to the end of a step.
template <int N>
void follow(Sensitive<N>& state, const Sensitive<N>& input, const LagStepLinearization& step, Eigen::Index lag_index,
            const Eigen::Matrix<double, 1, N>& duration_slope) {
  if constexpr (N > 0) {
    state.slope = (step.by_duration.output * duration_slope + step.by_output.output * state.slope +
                   step.by_input.output * input.slope)
                      .eval();
    state.slope[lag_index] += step.by_time_constant.output;
  }
  state.value = step.value.output;
}

/// Advances one lag over a step whose duration may move with the parameters; returns the integral.
template <int N>
Sensitive<N> advance(Sensitive<N>& state, const Sensitive<N>& input, const LagDecay& decay, Eigen::Index lag_index,
                     const Eigen::Matrix<double, 1, N>& duration_slope) {
  const auto step = linearize_lag_step(state.value, input.value, decay);
  Sensitive<N> integral{.value = step.value.integral};
  if constexpr (N > 0) {
    integral.slope = step.by_duration.integral * duration_slope + step.by_output.integral * state.slope +
                     step.by_input.integral * input.slope;
    integral.slope[lag_index] += step.by_time_constant.integral;
  }
  follow(state, input, step, lag_index, duration_slope);
  return integral;
}

}  // namespace slipwise
