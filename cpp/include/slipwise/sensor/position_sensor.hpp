// SPDX-License-Identifier: Apache-2.0
// A sensor of positions: headings are courses of chords that end there, and a model's path makes the same courses
// (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/sensor/pose_sensor.hpp"
#include "slipwise/sensor/seen.hpp"

namespace slipwise {

/// The straight line to a measured position from an earlier one. Its course makes a heading there.
struct Chord {
  double from = 0.0;    ///< stamp of the earlier position [s]
  double offset = 0.0;  ///< what adds to the course to make the heading, as far as the inputs tell [rad]
};

/// The positions that a measurement is made of: where the chord at its start begins, its start, where the chord at its
/// end begins, and its end.
enum CoursePoint : std::uint8_t { kStartChord, kStart, kEndChord, kEnd };
inline constexpr std::size_t kCoursePoints = 4;

/// Rows: x and y of the end as seen from the start, and, unless a gyro measures that, the turn of the heading.
struct PositionSensor {
  std::array<Chord, 2> chords = {};            ///< to the start and to the end
  std::array<PoseStdRatio, 2> std_ratio = {};  ///< of the positions at the start and at the end
  bool turn = true;                            ///< whether the turn of the courses is a row

  Directions directions() const;
  Moments moments(double start, double end) const;
  Seen see(const View& view) const;
  RowsCovariance noise(const View& view, const MotionNoise& noise) const;
  /// Chords begin so much earlier [s].
  void come_earlier(double seconds);
};

}  // namespace slipwise
