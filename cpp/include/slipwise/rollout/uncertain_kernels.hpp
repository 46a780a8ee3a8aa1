// SPDX-License-Identifier: Apache-2.0
// The kernels of tangents and of futures, for the level of the file that compiles them.
#pragma once

#include <cstddef>

#include "slipwise/rollout/lane_futures.hpp"
#include "slipwise/rollout/lane_limiter.hpp"
#include "slipwise/rollout/lane_tangents.hpp"

namespace slipwise {

template <class Level, typename Scalar>
UncertainKernels<Scalar> uncertain_kernels() {
  constexpr std::size_t kLanes = Lanes<Unpaired<Level>, Scalar>::kLanes;
  const auto limit = limit_block<Unpaired<Level>, Scalar>;
  return {.tangents = {roll_tangents<Level, Scalar>, limit, nullptr, kLanes},
          .futures = {roll_futures<Level, Scalar>, limit, nullptr, kLanes}};
}

}  // namespace slipwise
