// SPDX-License-Identifier: Apache-2.0
// A segment: two measured poses of one drive, and where the second lies as observed from the first.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/segment/ground.hpp"

namespace slipwise {

/// How exact a measured pose is said to be beside others: factors of the standard deviations of its noise.
struct PoseStdRatio {
  double xy = 1.0;
  double yaw = 1.0;
};

/// The straight line to a measured position from an earlier one. Its course makes a heading there.
struct Chord {
  double from = 0.0;    ///< stamp of the earlier position [s]
  double offset = 0.0;  ///< what adds to the course to make the heading, as far as the inputs tell [rad]
};

/// Where several sources measure poses: what is particular to the one that measured a segment.
struct SegmentSource {
  std::size_t number = 0;
  Eigen::Vector3d noise_factor = {1.0, 1.0, 1.0};  ///< of the variances of (x, y, theta)
  bool own_noise = false;  ///< the factor is all of the noise's size: the filters' scale is not that of this source
  /// The segment says where its sensor sits, and its stamps are those of the inputs, even where the model learns the
  /// place and the clock of the first.
  bool own_calibration = false;
  bool heading_only = false;  ///< no pose was measured, but the turn alone, by a gyro
};

struct Segment {
  double start;                                     ///< stamp of the first pose [s]
  double end;                                       ///< stamp of the second pose [s]
  Pose2 measured = {};                              ///< T_start_end, heading unwrapped
  std::optional<BodyTwist> initial = {};            ///< the drive's measured twist at the start, or where `known` ends
  double gx = 0.0;                                  ///< body-frame gravity [m/s^2] all along, where `ground` is unknown
  double gy = 0.0;                                  ///< [m/s^2]
  std::optional<MeasuredActuator> known = {};       ///< what was measured of the drive; `initial` is where it ends
  Pose2 sensor = {};                                ///< known pose in base_link of what `measured` is the motion of
  std::array<PoseStdRatio, 2> pose_std_ratio = {};  ///< of the first and the second pose
  std::shared_ptr<const Ground> ground = {};        ///< what tilts the robot; nothing on level ground
  /// Where the poses are positions: the chords to the first and to the second, whose courses stand for headings.
  std::optional<std::array<Chord, 2>> chords = {};
  /// Between positions, where a gyro measured the turn and not the chords: its standard deviation [rad].
  std::optional<double> gyro_std = {};
  double heading = 0.0;  ///< of the first pose in the frame of the poses [rad]; forces fixed there depend on it
  std::optional<SegmentSource> source = {};
};

/// Whether a filter learns from it how large noise is.
inline bool shows_noise(const Segment& segment) { return !segment.source || !segment.source->own_noise; }

/// The number of the source; that of the first where there is one alone.
inline std::size_t source_number(const Segment& segment) { return segment.source ? segment.source->number : 0; }

}  // namespace slipwise
