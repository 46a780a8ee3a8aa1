// SPDX-License-Identifier: Apache-2.0
// One walk per channel over delayed inputs and the moments asked for.
#include "slipwise/actuator/chain_output.hpp"

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {

OutputChannel speed_channel(const CommandChain& chain) {
  return {&BodyTwist::v, chain.gain_v, chain.lag_v, chain.delay_v};
}

OutputChannel turn_channel(const CommandChain& chain) {
  return {&BodyTwist::omega, chain.gain_omega, chain.lag_omega, chain.delay_omega};
}

void channel_output(const InputTrack& inputs, const OutputChannel& channel, std::span<const double> times,
                    const BodyTwist& initial, std::span<double> output) {
  if (times.empty()) {
    return;
  }
  double now = times.front();
  double state = initial.*channel.twist;
  std::size_t next = inputs.count_until(now - channel.delay);
  double held = next == 0 ? 0.0 : channel.gain * inputs.sample(next - 1).*channel.twist;
  const auto go_to = [&](double then) {
    state = lag_output(state, held, channel.lag, then - now);
    now = then;
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (; next < inputs.size() && inputs.time(next) + channel.delay < times[i]; ++next) {
      const double changed = channel.gain * inputs.sample(next).*channel.twist;
      if (changed != held) {
        go_to(inputs.time(next) + channel.delay);
        held = changed;
      }
    }
    go_to(times[i]);
    output[i] = state;
  }
}

ChainOutput chain_output(const InputTrack& inputs, const CommandChain& chain, std::span<const double> times,
                         const BodyTwist& initial) {
  ChainOutput output{.v = std::vector<double>(times.size()), .omega = std::vector<double>(times.size())};
  channel_output(inputs, speed_channel(chain), times, initial, output.v);
  channel_output(inputs, turn_channel(chain), times, initial, output.omega);
  return output;
}

}  // namespace slipwise
