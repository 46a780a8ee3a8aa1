// SPDX-License-Identifier: Apache-2.0
// One channel of the drive from step to step: two lags side by side, with derivatives by the chain's parameters
// (derivations.md, section 4).
#pragma once

#include "slipwise/actuator/channel_response.hpp"
#include "slipwise/actuator/first_order_lag.hpp"
#include "slipwise/actuator/sensitive_lag.hpp"
#include "slipwise/actuator/slow_mode.hpp"

namespace slipwise {

using ChainRow = Eigen::Matrix<double, 1, kChainParameters>;
using ChainValue = Sensitive<kChainParameters>;

/// Where the parameters of speed and yaw rate stand among the chain's.
inline constexpr ChannelPlaces kSpeedPlaces{.lag = 0, .delay = 2, .gain = 5, .slow_share = 7, .slow_lag = 9};
inline constexpr ChannelPlaces kTurnPlaces{.lag = 1, .delay = 3, .gain = 6, .slow_share = 8, .slow_lag = 10};

/// Advances one lag over a step; returns the integral.
inline double advance(ChainValue& state, double input, const LagDecay& decay) {
  const LagStep step = linearize_lag_step(state.value, input, decay).value;
  state.value = step.output;
  return step.integral;
}

/// How the gaps of a channel's two lags close over a step.
struct ChannelDecay {
  LagDecay fast, slow;

  ChannelDecay(const ChannelResponse& response, double duration)
      : fast(response.lag, duration), slow(response.slow_lag, duration) {}
};

/// One channel of the drive: two lags side by side.
class DriveChannel {
 public:
  DriveChannel(const ChannelResponse& response, const ChannelPlaces& places) : response_(response), places_(places) {}

  /// Settled on an input that was held for long.
  void settle(double input) {
    moves_ = input != 0.0;
    fast_ = part_of<kChainParameters>(input, response_, places_, false);
    slow_ = response_.has_slow_part() ? part_of<kChainParameters>(input, response_, places_, true) : ChainValue{};
  }

  /// The whole was measured while `input` acts.
  void measured(double value, double input) {
    moves_ = moves_ || value != 0.0;
    if (!response_.has_slow_part()) {
      fast_ = {.value = value};
      return;
    }
    const ChainValue at_fast = part_of<kChainParameters>(input, response_, places_, false);
    slow_ = slow_mode<ChainValue>({.left = {value - fast_.value, -fast_.slope},
                                   .modelled = slow_,
                                   .settled = part_of<kChainParameters>(input, response_, places_, true),
                                   .carried = {value - at_fast.value, -at_fast.slope}});
    fast_ = {value - slow_.value, -slow_.slope};
  }

  /// It was measured before any input acts: an input that keeps it so acts until `begin`.
  void keep(double value) {
    moves_ = value != 0.0;
    fast_ = {.value = (1.0 - response_.share()) * value};
    slow_ = {.value = response_.share() * value};
    if (response_.has_slow_part()) {
      fast_.slope[places_.slow_share] = -value;
      slow_.slope[places_.slow_share] = value;
    }
    kept_ = true;
  }
  void begin() { kept_ = false; }

  /// Advances over a step; returns the integral.
  double step(double input, const ChannelDecay& decay) {
    if (rests(input)) {
      return 0.0;
    }
    if (kept_) {
      return (fast_.value + slow_.value) * decay.fast.duration;
    }
    double integral = advance(fast_, response_.fast_share() * input, decay.fast);
    if (response_.has_slow_part()) {
      integral += advance(slow_, response_.share() * response_.gain * input, decay.slow);
    }
    return integral;
  }

  /// Goes on for a while that nobody looks at, with slopes.
  void follow(double input, const ChannelDecay& decay, const ChainRow& duration_slope) {
    if (rests(input) || kept_) {
      return;
    }
    const ChainValue fast = part_of<kChainParameters>(input, response_, places_, false);
    slipwise::follow(fast_, fast, linearize_lag_step(fast_.value, fast.value, decay.fast), places_.lag, duration_slope);
    if (response_.has_slow_part()) {
      const ChainValue slow = part_of<kChainParameters>(input, response_, places_, true);
      slipwise::follow(slow_, slow, linearize_lag_step(slow_.value, slow.value, decay.slow), places_.slow_lag,
                       duration_slope);
    }
  }

  ChainValue linearize_step(double input, const ChannelDecay& decay, const ChainRow& duration_slope) {
    if (rests(input)) {
      return {};
    }
    if (kept_) {
      const double value = fast_.value + slow_.value;
      return {value * decay.fast.duration, value * duration_slope};
    }
    ChainValue integral = advance(fast_, part_of<kChainParameters>(input, response_, places_, false), decay.fast,
                                  places_.lag, duration_slope);
    if (response_.has_slow_part()) {
      const ChainValue slow = advance(slow_, part_of<kChainParameters>(input, response_, places_, true), decay.slow,
                                      places_.slow_lag, duration_slope);
      integral.value += slow.value;
      integral.slope += slow.slope;
    }
    return integral;
  }

  /// Without lag, the derivative of a step's integral by the gain.
  double by_gain(double input, double duration) const { return kept_ ? 0.0 : input * duration; }

 private:
  /// Most robots never drive sideways. What has not moved, and is not commanded to, has no slopes either.
  bool rests(double input) {
    moves_ = moves_ || (input != 0.0 && !kept_);
    return !moves_;
  }

  ChannelResponse response_;
  ChannelPlaces places_;
  ChainValue fast_, slow_;
  bool moves_ = false;
  bool kept_ = false;
};

}  // namespace slipwise
