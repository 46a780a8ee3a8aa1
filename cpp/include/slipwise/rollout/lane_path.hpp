// SPDX-License-Identifier: Apache-2.0
// Paths in lanes: exact steps that carry the heading's cosine and sine along.
#pragma once

#include "slipwise/lie/lane_arc.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_slip.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// Displacements from the start, so that far from the map's origin no digits are lost.
template <class L, typename Scalar>
struct PathLanes {
  typename L::Row x, y;
  typename L::Row turned;
  typename L::Row cosine, sine;    ///< of the heading
  typename L::Row widest_squared;  ///< largest squared turn of a step

  SLIPWISE_LANES explicit PathLanes(const LaneBlock<Scalar>& block) {
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      x.part[u] = y.part[u] = turned.part[u] = widest_squared.part[u] = typename L::Vector{};
      load(block.cosine + u * L::kWidth, cosine.part[u]);
      load(block.sine + u * L::kWidth, sine.part[u]);
    }
  }

  /// The exponential of the tangent (derivations.md, section 2). With E = A + iB and the heading as a complex number h,
  /// the step moves by (h E) times the tangent and turns h by i f (h E).
  template <bool kWide>
  SLIPWISE_LANES void step(const TangentLanes<L>& tangent) {
#pragma GCC unroll 8
    for (std::size_t u = 0; u < L::kVectors; ++u) {
      const auto f = tangent.turn.part[u];
      const auto squared = f * f;
      widest_squared.part[u] = squared > widest_squared.part[u] ? squared : widest_squared.part[u];
      LaneArc<typename L::Vector> arc;
      if constexpr (kWide) {
        wide_lane_arc<Scalar>(f, arc);
      } else {
        lane_arc<Scalar>(f, arc);
      }
      const auto along = arc.a * cosine.part[u] - arc.b * sine.part[u];
      const auto across = arc.a * sine.part[u] + arc.b * cosine.part[u];
      const auto& forward = tangent.forward.part[u];
      const auto& left = tangent.left.part[u];
      x.part[u] = x.part[u] + along * forward - across * left;
      y.part[u] = y.part[u] + across * forward + along * left;
      cosine.part[u] = cosine.part[u] - f * across;
      sine.part[u] = sine.part[u] + f * along;
      turned.part[u] = turned.part[u] + f;
    }
  }
};

}  // namespace slipwise
