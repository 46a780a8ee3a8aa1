// SPDX-License-Identifier: Apache-2.0
// Attitudes and planes.
#include "slipwise/segment/ground.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

namespace slipwise {
namespace {

/// Roll and pitch of a robot that sees the ground rise by `ahead` and `left` per metre.
Standing standing(double z, double ahead, double left) {
  const double pitch = -std::atan(ahead);
  return {.z = z, .roll = std::atan(left * std::cos(pitch)), .pitch = pitch};
}

}  // namespace

Grade grade_of(const Tilt& tilt) {
  return {.rise_x = -std::tan(tilt.pitch), .rise_y = std::tan(tilt.roll) / std::cos(tilt.pitch)};
}

Tilt tilt_between(const MeasuredTilts& measured, double t) {
  const auto after = std::ranges::upper_bound(measured.at, t, {}, &Tilt::t);
  if (after == measured.at.begin()) {
    return measured.at.empty() ? Tilt{t, 0.0, 0.0} : measured.at.front();
  }
  const Tilt& before = *std::prev(after);
  if (after == measured.at.end()) {
    return before;
  }
  const double part = (t - before.t) / (after->t - before.t);
  return {t, before.roll + part * (after->roll - before.roll), before.pitch + part * (after->pitch - before.pitch)};
}

Standing standing_at(const Ground& ground, const Pose2& pose) {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  if (const auto* plane = std::get_if<Grade>(&ground)) {
    return standing(plane->rise_x * pose.x + plane->rise_y * pose.y, plane->rise_x * c + plane->rise_y * s,
                    plane->rise_y * c - plane->rise_x * s);
  }
  const auto* mapped = std::get_if<MappedGround>(&ground);
  if (mapped == nullptr) {
    throw std::invalid_argument("a measured attitude tells no height; give a grade or a map of elevations");
  }
  const Pose2 there = compose(mapped->start, pose);
  const auto rise = mapped->map->rise(there.x, there.y);
  const double ch = std::cos(there.theta);
  const double sh = std::sin(there.theta);
  return standing(mapped->map->height(there.x, there.y) - mapped->map->height(mapped->start.x, mapped->start.y),
                  rise.x * ch + rise.y * sh, rise.y * ch - rise.x * sh);
}

}  // namespace slipwise
