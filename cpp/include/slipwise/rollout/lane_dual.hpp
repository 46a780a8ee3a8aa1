// SPDX-License-Identifier: Apache-2.0
// Lanes with derivatives: the equations of the kernels on dual numbers, each a vector of lanes.
#pragma once

#include <cstddef>

#include "slipwise/linear/dual_number.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// The lanes of `L`, with derivatives by N variables.
template <class L, int N>
struct DualLanes {
  using Scalar = L::Scalar;
  using Vector = Dual<typename L::Vector, N>;
  static constexpr std::size_t kLanes = L::kLanes;
};

/// At zero the mean of the derivatives on both sides.
template <class Vector, int N>
SLIPWISE_LANES Dual<Vector, N> magnitude(const Dual<Vector, N>& a) {
  return Dual<Vector, N>::chained(magnitude(a.value), sign(a.value, Vector{} + static_cast<ElementOf<Vector>::Type>(1)),
                                  a);
}
template <class Vector, int N>
SLIPWISE_LANES Dual<Vector, N> sign(const Dual<Vector, N>& a, const Dual<Vector, N>& one) {
  return sign(a.value, one.value);
}
template <class Vector, int N>
SLIPWISE_LANES Dual<Vector, N> any_nonzero(const Dual<Vector, N>& a, const Dual<Vector, N>& b,
                                           const Dual<Vector, N>& one) {
  return any_nonzero(a.value, b.value, one.value);
}

}  // namespace slipwise
