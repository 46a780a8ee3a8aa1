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
#include "slipwise/segment/segment.hpp"
#include "slipwise/segment/sight.hpp"
#include "slipwise/slip/slip_ahead.hpp"

namespace slipwise {

/// Exact: exponential of each step's mean twist. Rk4: the thesis's Runge-Kutta steps, for comparison.
enum class Integrator : std::uint8_t { Exact, Rk4 };

/// The robot's path observed from its start, which is the segment's, or earlier where a sensor looks at that.
struct SegmentPath {
  std::vector<double> times;              ///< [steps + 1], [s], in pose stamps
  std::vector<Pose2> poses;               ///< [steps + 1], the first is the origin
  std::vector<Eigen::Vector3d> tangents;  ///< [steps], twist * duration with slip
  std::vector<ActuatorStep> drive;        ///< [steps], the drive without slip
  std::vector<Measured> measured = {};  ///< that of the segment, sensors where they sit also where a model learns that
  std::vector<Sight> sights = {};       ///< what each of the sensors looks at

  /// Where the first sensor sits in base_link.
  const Pose2& sensor() const { return measured.front().sensor.place; }
  /// What each sensor sees of it.
  std::vector<Seen> seen() const;
  /// R, before the factors of the noise: what each sensor says of rows that it measured, or might have.
  RowsCovariance measurement_noise(const Rows& rows, const MotionNoise& noise) const;
  /// What all sensors see of it: what is measured of the segment is compared with that.
  Rows rows() const { return stacked(seen()); }
  Directions directions() const { return directions_of(measured); }
  /// The robot's motion that a motion of the first sensor tells, X M X^-1.
  Pose2 robot_motion(const Pose2& motion) const;
};

/// A model that learns where the sensor sits says so itself; otherwise the segment does.
/// Where slip becomes another along the path, `ahead` says so.
/// \throws std::invalid_argument when the parameters do not fit the model.
SegmentPath integrate_segment(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                              const InputHistory& inputs, const Segment& segment,
                              Integrator integrator = Integrator::Exact, const SlipAhead& ahead = {});

struct SegmentLinearization {
  SegmentPath path;
  Rows predicted;             ///< what the sensors see of it
  RowsJacobian by_parameter;  ///< derivative of `predicted`

  /// T_start_end of a sensor of poses; of others, what they tell of it.
  Pose2 pose() const { return Pose2::from_vector(chart_of(path.directions(), predicted)); }
};

/// Measured minus predicted.
Rows error_of(const Segment& segment, const SegmentLinearization& at);
/// The same, turns by their shorter way.
Rows shorter_error_of(const Segment& segment, const SegmentLinearization& at);

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
