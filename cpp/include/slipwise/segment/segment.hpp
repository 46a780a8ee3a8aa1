// SPDX-License-Identifier: Apache-2.0
// A segment: a stretch of one drive, what acted on it, and what sensors measured of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/ground.hpp"
#include "slipwise/sensor/sensor.hpp"

namespace slipwise {

struct Segment {
  double start;                                        ///< stamp of the first pose [s]
  double end;                                          ///< stamp of the second pose [s]
  std::vector<Measured> measured = measured_pose({});  ///< between start and end, by each sensor
  std::optional<BodyTwist> initial = {};               ///< the drive's twist at the start, or where `known` ends
  double gx = 0.0;                                     ///< body-frame gravity [m/s^2] all along, without `ground`
  double gy = 0.0;                                     ///< [m/s^2]
  std::optional<MeasuredActuator> known = {};          ///< what was measured of the drive; `initial` is where it ends
  std::shared_ptr<const Ground> ground = {};           ///< what tilts the robot; nothing on level ground
  double heading = 0.0;  ///< of the first pose in the frame of the poses [rad]; forces fixed there depend on it
  double ahead = 0.0;    ///< [s] after the end in which inputs are known, for poses that are stamped early
};

/// Whether a filter learns from it how large noise is.
inline bool shows_noise(const Segment& segment) {
  return std::ranges::none_of(segment.measured, [](const Measured& each) { return each.sensor.own_noise; });
}

/// The number of the source; that of the first where several measure it.
inline std::size_t source_number(const Segment& segment) { return segment.measured.front().sensor.number; }

/// When the path of a segment begins and ends [s]: no later and no earlier than what any sensor looks at.
std::array<double, 2> path_span(const Segment& segment);
inline double path_start(const Segment& segment) { return path_span(segment)[0]; }

}  // namespace slipwise
