// SPDX-License-Identifier: Apache-2.0
// Which part of a measured speed a channel's slow mode holds (derivations/actuator.md).
#pragma once

#include <algorithm>

#include "slipwise/actuator/axis_response.hpp"
#include "slipwise/linear/plain_value.hpp"

namespace slipwise {

/// A channel where its whole speed was measured. `T` is a number, or one with derivatives.
template <typename T>
struct MeasuredChannel {
  T left;      ///< of the measured speed, what the fast mode does not explain
  T modelled;  ///< the slow mode, as the inputs alone drive it
  T settled;   ///< what the slow mode settles at under the input that acts now
  T bound;     ///< what the slow mode may hold beside the two above
};

/// The slow mode holds the rest, within the range of the other three.
///
/// With the measured speed less what the fast mode settles at as the bound, a constant input carries the speed from the
/// measured one to its own, and not beyond. With the slow mode's fraction of the measured speed, any inputs do so: each
/// mode begins where the inputs or the measured speed, held for long, would have brought it.
template <typename T>
T slow_mode(const MeasuredChannel<T>& channel) {
  const auto by_value = [](const T& a, const T& b) { return value_of(a) < value_of(b); };
  const T low = std::min({channel.modelled, channel.settled, channel.bound}, by_value);
  const T high = std::max({channel.modelled, channel.settled, channel.bound}, by_value);
  return std::clamp(channel.left, low, high, by_value);
}

}  // namespace slipwise
