// SPDX-License-Identifier: Apache-2.0
// One walk per channel over delayed inputs and the moments asked for.
#include "slipwise/actuator/chain_output.hpp"

#include "slipwise/actuator/first_order_lag.hpp"

namespace slipwise {
namespace {

struct Channel {
  double BodyTwist::* input;
  double gain, lag, delay;
};

std::vector<double> follow(const InputTrack& inputs, const Channel& channel, std::span<const double> times,
                           double output) {
  std::vector<double> result;
  result.reserve(times.size());
  if (times.empty()) {
    return result;
  }
  double now = times.front();
  std::size_t next = inputs.count_until(now - channel.delay);
  double held = next == 0 ? 0.0 : channel.gain * inputs.sample(next - 1).*channel.input;
  const auto go_to = [&](double then) {
    output = lag_output(output, held, channel.lag, then - now);
    now = then;
  };
  for (const double t : times) {
    for (; next < inputs.size() && inputs.time(next) + channel.delay < t; ++next) {
      const double changed = channel.gain * inputs.sample(next).*channel.input;
      if (changed != held) {
        go_to(inputs.time(next) + channel.delay);
        held = changed;
      }
    }
    go_to(t);
    result.push_back(output);
  }
  return result;
}

}  // namespace

ChainOutput chain_output(const InputTrack& inputs, const CommandChain& chain, std::span<const double> times,
                         const BodyTwist& initial) {
  return {
      follow(inputs, {&BodyTwist::v, chain.gain_v, chain.lag_v, chain.delay_v}, times, initial.v),
      follow(inputs, {&BodyTwist::omega, chain.gain_omega, chain.lag_omega, chain.delay_omega}, times, initial.omega)};
}

}  // namespace slipwise
