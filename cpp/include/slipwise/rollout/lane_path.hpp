// SPDX-License-Identifier: Apache-2.0
// Paths in lanes: exact steps that carry the heading's cosine and sine along.
#pragma once

#include "slipwise/lie/lane_arc.hpp"
#include "slipwise/rollout/lane_job.hpp"
#include "slipwise/rollout/lane_slip.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// Displacements from the start, so that far from the map's origin no digits are lost.
template <class L>
struct PathLanes {
  L::Vector x, y;
  L::Vector turned;
  L::Vector cosine, sine;    ///< of the heading
  L::Vector widest_squared;  ///< largest squared turn of a step
};

template <class L, typename Scalar = L::Scalar>
SLIPWISE_LANES void start_path(const LaneBlock<Scalar>& block, PathLanes<L>& path) {
  fill(typename L::Scalar{}, path.x);
  path.y = path.turned = path.widest_squared = path.x;
  load(block.cosine, path.cosine);
  load(block.sine, path.sine);
}

template <typename Scalar, bool kWide, class Vector>
SLIPWISE_LANES void find_arc(const Vector& f, LaneArc<Vector>& arc) {
  if constexpr (kWide) {
    wide_lane_arc<Scalar>(f, arc);
  } else {
    lane_arc<Scalar>(f, arc);
  }
}
template <typename Scalar, bool kWide, class Half>
SLIPWISE_LANES void find_arc(const Pair<Half>& f, LaneArc<Pair<Half>>& arc) {
  LaneArc<Half> low;
  LaneArc<Half> high;
  find_arc<Scalar, kWide>(f.low, low);
  find_arc<Scalar, kWide>(f.high, high);
  arc = {{low.a, high.a}, {low.b, high.b}};
}

/// The exponential of the tangent (derivations/model.md). With E = A + iB and the heading as a complex number h,
/// the step moves by (h E) times the tangent and turns h by i f (h E).
template <class L, bool kWide>
SLIPWISE_LANES void step(const TangentLanes<L>& tangent, PathLanes<L>& path) {
  const auto& f = tangent.turn;
  const auto squared = f * f;
  path.widest_squared = larger(squared, path.widest_squared);
  LaneArc<typename L::Vector> arc;
  find_arc<typename L::Scalar, kWide>(f, arc);
  const auto along = arc.a * path.cosine - arc.b * path.sine;
  const auto across = arc.a * path.sine + arc.b * path.cosine;
  path.x = path.x + along * tangent.forward - across * tangent.left;
  path.y = path.y + across * tangent.forward + along * tangent.left;
  path.cosine = path.cosine - f * across;
  path.sine = path.sine + f * along;
  path.turned = path.turned + f;
}

}  // namespace slipwise
