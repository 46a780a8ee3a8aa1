// SPDX-License-Identifier: Apache-2.0
// What an axis makes of a command that is held for long, once for every kind of number: doubles, and lanes of rollouts.
#pragma once

#include "slipwise/lie/lane_function.hpp"

namespace slipwise {

/// What is slower than the dead-band gives zero, what is faster than the saturation gives the saturation.
/// \param limits of a kind of numbers: `AxisLimits`, or what rollouts make of it.
template <class Limits, class S>
SLIPWISE_LANES S limited(const Limits& limits, const S& command) {
  const S none{};
  const S most = none + limits.saturation;
  const S size = command < none ? -command : command;
  const S passed = size < none + limits.dead_band ? none : command;
  const S below = passed < most ? passed : most;
  return below > -most ? below : -most;
}

}  // namespace slipwise
