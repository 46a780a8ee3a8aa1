// SPDX-License-Identifier: Apache-2.0
// Attitudes and planes.
#include "slipwise/segment/ground.hpp"

#include <cmath>
#include <stdexcept>

#include "slipwise/segment/ground_along.hpp"

namespace slipwise {
namespace {

/// Above where the path begins [m].
double height_at(const Ground& ground, const Pose2& pose) {
  if (const auto* plane = std::get_if<Grade>(&ground)) {
    return plane->rise_x * pose.x + plane->rise_y * pose.y;
  }
  const auto& mapped = std::get<MappedGround>(ground);
  const Pose2 there = compose(mapped.start, pose);
  return mapped.map->height(there.x, there.y) - mapped.map->height(mapped.start.x, mapped.start.y);
}

}  // namespace

Grade grade_of(const Tilt& tilt) {
  return {.rise_x = -std::tan(tilt.pitch), .rise_y = std::tan(tilt.roll) / std::cos(tilt.pitch)};
}

Tilt tilt_between(const MeasuredTilts& measured, double t) {
  const auto [roll, pitch] = roll_and_pitch(measured, t);
  return {t, roll, pitch};
}

Standing standing_at(const Ground& ground, const Pose2& pose) {
  if (std::holds_alternative<MeasuredTilts>(ground)) {
    throw std::invalid_argument("a measured attitude tells no height; give a grade or a map of elevations");
  }
  const auto rise = rise_along<double>(ground, {pose.x, pose.y, pose.theta});
  const double pitch = -std::atan(rise.ahead);
  return {.z = height_at(ground, pose), .roll = std::atan(rise.left * std::cos(pitch)), .pitch = pitch};
}

}  // namespace slipwise
