// SPDX-License-Identifier: Apache-2.0
// Segments between positions: headings are courses of chords that end there, and a model's path makes the same courses
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// The positions that a segment between positions is made of, in this order: where the chord at its start begins, its
/// start, where the chord at its end begins, and its end.
enum CoursePoint : std::uint8_t { kStartChord, kStart, kEndChord, kEnd };
inline constexpr std::size_t kCoursePoints = 4;

/// Where these are on a path, and what makes headings of courses.
struct CoursePlaces {
  std::array<std::size_t, kCoursePoints> at;  ///< places of the poses
  std::array<double, 2> offset;               ///< heading minus course, of the start and of the end [rad]
  double turn;                                ///< the measured turn, next to which a predicted one is unwrapped [rad]
  std::optional<double> gyro_std = {};        ///< where a gyro measured the turn: its standard deviation [rad]
};

using CoursePositions = std::array<Eigen::Vector2d, kCoursePoints>;
using ByPosition = std::array<Eigen::Matrix<double, 3, 2>, kCoursePoints>;

/// When the path of a segment begins [s]: at its start, or where the first of its chords does.
double path_start(const Segment& segment);
/// Cuts steps where chords begin and at the segment's start, which are fixed moments whatever the actuator does.
/// Returns where the points are among the poses. The segment must be one between positions.
CoursePlaces cut_for_course(ActuatorSteps& drive, const Segment& segment);
/// The chart (x, y, theta) of the end as seen from the start, headings by courses; where a gyro measures, the turn is
/// the robot's own, `turned` [rad].
Pose2 course_motion(const CoursePositions& points, const CoursePlaces& places, double turned);
/// Its derivative by each of the positions. The robot's own turn depends on none of them.
ByPosition course_by_position(const CoursePositions& points, const CoursePlaces& places);

}  // namespace slipwise
