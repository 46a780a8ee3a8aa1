// SPDX-License-Identifier: Apache-2.0
// Covariances of poses, in lanes: sums of squares, carried along the path.
#pragma once

#include "slipwise/rollout/lane_path.hpp"
#include "slipwise/rollout/lanes.hpp"

namespace slipwise {

/// A symmetric matrix of (x, y, theta).
template <class Vector>
struct SymmetricLanes {
  Vector xx, xy, yy, xt, yt, tt;
};

/// Adds `variance` times the square of (x, y, turn).
template <class Vector, class Number>
SLIPWISE_LANES void add_square(const Vector& x, const Vector& y, const Vector& turn, const Number& variance,
                               SymmetricLanes<Vector>& sum) {
  const Vector scaled_x = x * variance, scaled_y = y * variance, scaled_turn = turn * variance;
  sum.xx = sum.xx + scaled_x * x;
  sum.xy = sum.xy + scaled_x * y;
  sum.yy = sum.yy + scaled_y * y;
  sum.xt = sum.xt + scaled_x * turn;
  sum.yt = sum.yt + scaled_y * turn;
  sum.tt = sum.tt + scaled_turn * turn;
}
/// Of what does not turn.
template <class Vector, class Number>
SLIPWISE_LANES void add_square(const Vector& x, const Vector& y, const Number& variance, SymmetricLanes<Vector>& sum) {
  const Vector scaled_x = x * variance;
  sum.xx = sum.xx + scaled_x * x;
  sum.xy = sum.xy + scaled_x * y;
  sum.yy = sum.yy + y * variance * y;
}

/// What moves the whole plane about the start of a rollout, as the pose at the end of its path is moved by it.
template <class L, class Vector = L::Vector>
SLIPWISE_LANES void carry_to(const PathLanes<L>& path, SymmetricLanes<Vector>& sum) {
  const Vector x_tt = path.x * sum.tt, y_tt = path.y * sum.tt;
  sum.xx = sum.xx - path.y * (sum.xt + sum.xt - y_tt);
  sum.xy = sum.xy + path.x * (sum.xt - y_tt) - path.y * sum.yt;
  sum.yy = sum.yy + path.x * (sum.yt + sum.yt + x_tt);
  sum.xt = sum.xt - y_tt;
  sum.yt = sum.yt + x_tt;
}

/// D S D with D = diag(roots) along axes of this direction, in the world's axes.
template <class Vector, typename Scalar>
SLIPWISE_LANES void scale_along(const Vector& cosine, const Vector& sine, const Scalar* roots,
                                SymmetricLanes<Vector>& sum) {
  const Vector a = cosine * cosine * roots[0] + sine * sine * roots[1];
  const Vector b = cosine * sine * (roots[0] - roots[1]);
  const Vector d = sine * sine * roots[0] + cosine * cosine * roots[1];
  const Vector xx = a * sum.xx + b * sum.xy, xy = a * sum.xy + b * sum.yy;
  const Vector yx = b * sum.xx + d * sum.xy, yy = b * sum.xy + d * sum.yy;
  const Vector xt = (a * sum.xt + b * sum.yt) * roots[2], yt = (b * sum.xt + d * sum.yt) * roots[2];
  sum = {xx * a + xy * b, xx * b + xy * d, yx * b + yy * d, xt, yt, sum.tt * (roots[2] * roots[2])};
}

}  // namespace slipwise
