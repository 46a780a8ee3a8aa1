// SPDX-License-Identifier: Apache-2.0
// Integrating the motion model over a segment, step by step and exactly, and its derivative by the parameters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/course.hpp"
#include "slipwise/segment/segment.hpp"
#include "slipwise/slip/slip_ahead.hpp"

namespace slipwise {

/// Exact: exponential of each step's mean twist. Rk4: the thesis's Runge-Kutta steps, for comparison.
enum class Integrator : std::uint8_t { Exact, Rk4 };

/// The robot's path observed from its start. Between positions it begins where the first of their chords does.
struct SegmentPath {
  std::vector<double> times;                        ///< [steps + 1], [s], in pose stamps
  std::vector<Pose2> poses;                         ///< [steps + 1], the first is the origin
  std::vector<Eigen::Vector3d> tangents;            ///< [steps], twist * duration with slip
  std::vector<ActuatorStep> drive;                  ///< [steps], the drive without slip
  Pose2 sensor;                                     ///< pose in base_link of the sensor that measures the path
  std::array<PoseStdRatio, 2> pose_std_ratio = {};  ///< of the segment's measured poses
  std::optional<CoursePlaces> course = {};          ///< where the segment lies between positions
  Eigen::Vector3d noise_factor = {1.0, 1.0, 1.0};   ///< of the variances of what measures it
  bool own_noise = false;                           ///< a learned scale of noise is not that of what measures it
  std::optional<double> heading_std = {};           ///< of the turn, where that alone is measured [rad]

  /// Where the sensor is at the points of the course, seen from the path's start.
  CoursePositions course_positions() const;
  /// By how much the robot turns between the start and the end of the course [rad].
  double course_turn() const;
  /// The sensor's motion, X^-1 T X, or between positions that by courses: what `Segment::measured` is compared with.
  Pose2 sensor_motion() const;
  /// The robot's motion that a sensor's motion tells, X M X^-1.
  Pose2 robot_motion(const Pose2& measured) const;
};

/// A model that learns where the sensor sits says so itself; otherwise the segment does.
/// Where slip becomes another along the path, `ahead` says so.
/// \throws std::invalid_argument when the parameters do not fit the model.
SegmentPath integrate_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                              const InputHistory& inputs, const Segment& segment,
                              Integrator integrator = Integrator::Exact, const SlipAhead& ahead = {});

struct SegmentLinearization {
  SegmentPath path;
  Pose2 predicted;                                        ///< T_start_end of the pose sensor
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_parameter;  ///< derivative of the chart (x, y, theta) of `predicted`
};

/// Value and exact derivative in one pass (prefix scan of derivations/model.md).
SegmentLinearization linearize_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                       const InputHistory& inputs, const Segment& segment);
/// The same by the slip parameters alone, which come first: cheaper where the actuator is learned too.
SegmentLinearization linearize_slip(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                    const InputHistory& inputs, const Segment& segment);
/// As `linearize_segment`, of the segment's beginnings: up to the first step's end after each `parts`-th of its time,
/// the last up to its own end.
std::vector<SegmentLinearization> linearize_beginnings(const MotionModel& model,
                                                       const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                       const InputHistory& inputs, const Segment& segment,
                                                       std::size_t parts);

}  // namespace slipwise
