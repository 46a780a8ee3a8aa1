// SPDX-License-Identifier: Apache-2.0
// Surfaces that a robot comes to, in lanes: how much of a step lies beyond an edge, and slips otherwise
// (derivations/surfaces.md).
#pragma once

#include "slipwise/rollout/lanes.hpp"
#include "slipwise/slip/path_edges.hpp"

namespace slipwise {

/// Which fraction of a step of `length`, from `travelled` on, lies beyond an edge [m].
template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void find_beyond(Scalar edge, const typename L::Vector& travelled, const typename L::Vector& length,
                                typename L::Vector& fraction) {
  const auto one = static_cast<Scalar>(1);
  const typename L::Vector step = length + static_cast<Scalar>(kEdgeWidth);
  const typename L::Vector beyond = (travelled + step - edge) / step;
  // between 0 and 1, without a branch
  copy((magnitude(beyond) - magnitude(beyond - one) + one) * static_cast<Scalar>(0.5), fraction);
}

}  // namespace slipwise
