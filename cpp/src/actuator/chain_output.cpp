// SPDX-License-Identifier: Apache-2.0
// One walk per axis.
#include "slipwise/actuator/chain_output.hpp"

namespace slipwise {

ActuatorAxis speed_axis(const CommandChain& chain) {
  return {&BodyTwist::v, {.gain = chain.gain_v, .lag = chain.lag_v, .slow_share = 0.0, .slow_lag = 0.0}, chain.delay_v};
}

ActuatorAxis turn_axis(const CommandChain& chain) {
  return {&BodyTwist::omega,
          {.gain = chain.gain_omega, .lag = chain.lag_omega, .slow_share = 0.0, .slow_lag = 0.0},
          chain.delay_omega};
}

ChainOutput chain_output(const InputTrack& inputs, const CommandChain& chain, std::span<const double> times,
                         const BodyTwist& initial) {
  ChainOutput output{.v = std::vector<double>(times.size()), .omega = std::vector<double>(times.size())};
  axis_speeds(inputs, speed_axis(chain), {.fast = initial.v, .slow = 0.0}, times, output.v);
  axis_speeds(inputs, turn_axis(chain), {.fast = initial.omega, .slow = 0.0}, times, output.omega);
  return output;
}

}  // namespace slipwise
