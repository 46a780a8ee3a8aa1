// SPDX-License-Identifier: Apache-2.0
// A step along tilted ground: what it is seen from above, and the gravity that pulls the robot on it
// (derivations/slopes-and-forces.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/segment/ground.hpp"
#include "slipwise/segment/path_step.hpp"

namespace slipwise {

/// A step on tilted ground. Seen from above, it is level * tangent + turned.
struct GroundStep {
  BodyGravity gravity;
  Eigen::Matrix3d level = Eigen::Matrix3d::Identity();  ///< from a body tangent to one in the horizontal plane
  double turned = 0.0;                                  ///< turn about the vertical by pitching while rolled [rad]

  Eigen::Vector3d seen_from_above(const Eigen::Vector3d& tangent) const {
    Eigen::Vector3d above = level * tangent;
    above.z() += turned;
    return above;
  }
};

/// The same with derivatives by what it is evaluated at: the pose (x, y, theta) amid the step, or, of a measured
/// attitude, the stamp of its start and its duration.
struct GroundStepLinearization {
  GroundStep step;
  std::array<Eigen::Matrix3d, 3> level_by;  ///< of each row of `level`: a row for each entry
  Eigen::RowVector3d turned_by;             ///< of `turned`
  Eigen::Matrix<double, 2, 3> gravity_by;   ///< of (gx, gy)
  Eigen::Matrix3d at_by_pose;               ///< of what it is evaluated at, by the pose at the step's start
  Eigen::Vector3d at_by_time;               ///< by the stamp of the step's start
  Eigen::Matrix<double, 3, 4> at_by_step;   ///< by (duration, forward, left, turn) of the step

  /// Derivative of `seen_from_above(tangent)` by what it is evaluated at, the tangent staying as it is.
  Eigen::Matrix3d above_by(const Eigen::Vector3d& tangent) const;
};

/// How many pieces of a step that lasts `duration` [s] are short enough for a tilt each.
std::size_t ground_pieces(double duration);
/// Steps cut into such pieces.
void cut_for_ground(ActuatorSteps& drive);

/// The step that begins at `pose` and stamp `t` [s].
GroundStep ground_step(const Ground& ground, const ActuatorStep& step, const Pose2& pose, double t);
/// The same with derivatives.
GroundStepLinearization linearize_ground_step(const Ground& ground, const ActuatorStep& step, const Pose2& pose,
                                              double t);

/// Derivative of a step's tangent, seen from above, by what its ground is evaluated at; `body` is the tangent in the
/// robot's axes.
Eigen::Matrix3d above_by_place(const GroundStepLinearization& ground, const ActuatorStep& step, const PathSlip& along,
                               const Eigen::Vector3d& body);

/// Derivative of the slip rates by the gravity (gx, gy).
Eigen::Matrix<double, 3, 2> slip_rate_by_gravity(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                                 const SlipState& state);

}  // namespace slipwise
