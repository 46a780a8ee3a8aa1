// SPDX-License-Identifier: Apache-2.0
// A step with its derivatives, in lanes.
#pragma once

#include "slipwise/rollout/lane_dual.hpp"
#include "slipwise/rollout/lane_path.hpp"

// Plain arrays: the functions of std::array would be compiled for the processor of one file and called from others.
// NOLINTBEGIN(modernize-avoid-c-arrays)
namespace slipwise {

/// Derivatives of where a step ends by its tangent. They are carried back to the start of the rollout, as if the whole
/// plane moved with the robot, so that those of all steps add up.
template <class Vector>
struct StepLanes {
  Vector x[3], y[3];  ///< by forward, left, turn; the heading turns with the last alone
};

/// Moves the path on by a step.
template <class L, class Vector = L::Vector>
SLIPWISE_LANES void step_with_tangents(const TangentLanes<L>& tangent, PathLanes<L>& path, StepLanes<Vector>& by) {
  using Scalar = L::Scalar;
  const Vector c = path.cosine, s = path.sine, f = tangent.turn;
  LaneArc<Vector> arc;
  find_arc<Scalar, true>(f, arc);
  by.x[0] = arc.a * c - arc.b * s;
  by.y[0] = arc.a * s + arc.b * c;
  by.x[1] = -by.y[0];
  by.y[1] = by.x[0];
  step<L, true>(tangent, path);
  LaneArc<Dual<Vector, 1>> narrow;  // with derivatives by the turn
  lane_arc<Scalar>(Dual<Vector, 1>::variable(f, 0), narrow);
  const auto wide = f * f > static_cast<Scalar>(kLaneTurn * kLaneTurn);
  const Vector safe = wide ? f : Vector{} + static_cast<Scalar>(1);
  const Vector along = wide ? (path.cosine - by.x[0]) / safe : narrow.a.by[0] * c - narrow.b.by[0] * s;
  const Vector across = wide ? (path.sine - by.y[0]) / safe : narrow.a.by[0] * s + narrow.b.by[0] * c;
  by.x[2] = along * tangent.forward - across * tangent.left + path.y;
  by.y[2] = across * tangent.forward + along * tangent.left - path.x;
}

}  // namespace slipwise
// NOLINTEND(modernize-avoid-c-arrays)
