// SPDX-License-Identifier: Apache-2.0
// The drive's speed and yaw rate at given moments, as wheel speeds measure them.
#pragma once

#include <span>
#include <vector>

#include "slipwise/actuator/command_chain.hpp"
#include "slipwise/actuator/input_track.hpp"

namespace slipwise {

/// One channel of the chain, without its slow part.
struct OutputChannel {
  double BodyTwist::* twist;  ///< the channel, of inputs and output
  double gain, lag, delay;
};
OutputChannel speed_channel(const CommandChain& chain);
OutputChannel turn_channel(const CommandChain& chain);

/// What the channel does at each of the `times` [s, increasing, in input stamps], as many as `output` holds.
/// The drive does `initial` at the first of them, as it was measured.
void channel_output(const InputTrack& inputs, const OutputChannel& channel, std::span<const double> times,
                    const BodyTwist& initial, std::span<double> output);

/// Both channels. A slow part is not followed.
struct ChainOutput {
  std::vector<double> v, omega;
};
ChainOutput chain_output(const InputTrack& inputs, const CommandChain& chain, std::span<const double> times,
                         const BodyTwist& initial);

}  // namespace slipwise
