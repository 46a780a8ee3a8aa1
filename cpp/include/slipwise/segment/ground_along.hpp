// SPDX-License-Identifier: Apache-2.0
// The ground where a robot is, in numbers with or without derivatives: how it rises, and how it was seen to tilt
// (derivations/slopes-and-forces.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <variant>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/plain_value.hpp"
#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// How the ground rises seen along a heading [m/m], and how the rise ahead changes along the path [1/m].
template <class Scalar>
struct RiseAlong {
  Scalar ahead, left;
  Scalar bend_ahead, bend_left;
};

/// On a plane or a map; the pose (x, y, theta) is seen from the path's first.
template <class Scalar>
RiseAlong<Scalar> rise_along(const Ground& ground, const std::array<Scalar, 3>& pose) {
  using std::cos;
  using std::sin;
  const Scalar c = cos(pose[2]);
  const Scalar s = sin(pose[2]);
  if (const auto* plane = std::get_if<Grade>(&ground)) {
    const Scalar x(plane->rise_x);
    const Scalar y(plane->rise_y);
    return {x * c + y * s, y * c - x * s, Scalar(0.0), Scalar(0.0)};
  }
  const auto& mapped = std::get<MappedGround>(ground);
  const double c0 = std::cos(mapped.start.theta);
  const double s0 = std::sin(mapped.start.theta);
  const auto rise = mapped.map->rise(Scalar(mapped.start.x) + Scalar(c0) * pose[0] - Scalar(s0) * pose[1],
                                     Scalar(mapped.start.y) + Scalar(s0) * pose[0] + Scalar(c0) * pose[1]);
  const Scalar ch = c * Scalar(c0) - s * Scalar(s0);  // of the heading on the map
  const Scalar sh = s * Scalar(c0) + c * Scalar(s0);
  const Scalar x_ahead = rise.xx * ch + rise.xy * sh;
  const Scalar y_ahead = rise.yx * ch + rise.yy * sh;
  const Scalar x_left = rise.xy * ch - rise.xx * sh;
  const Scalar y_left = rise.yy * ch - rise.yx * sh;
  return {rise.x * ch + rise.y * sh, rise.y * ch - rise.x * sh, x_ahead * ch + y_ahead * sh, x_left * ch + y_left * sh};
}

/// Roll and pitch at a stamp [rad], along the shorter way from one attitude to the next; level where nothing was
/// measured.
template <class Scalar>
std::array<Scalar, 2> roll_and_pitch(const MeasuredTilts& measured, const Scalar& t) {
  const auto after = std::ranges::upper_bound(measured.at, value_of(t), {}, &Tilt::t);
  if (measured.at.empty()) {
    return {Scalar(0.0), Scalar(0.0)};
  }
  if (after == measured.at.begin() || after == measured.at.end()) {
    const Tilt& held = after == measured.at.end() ? measured.at.back() : measured.at.front();
    return {Scalar(held.roll), Scalar(held.pitch)};
  }
  const Tilt& before = *std::prev(after);
  const Scalar part = (t - Scalar(before.t)) / Scalar(after->t - before.t);
  return {Scalar(before.roll) + part * Scalar(wrap_angle(after->roll - before.roll)),
          Scalar(before.pitch) + part * Scalar(wrap_angle(after->pitch - before.pitch))};
}

}  // namespace slipwise
