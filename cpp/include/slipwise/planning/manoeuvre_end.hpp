// SPDX-License-Identifier: Apache-2.0
// Where a manoeuvre leads through the motion model, and the exact derivative by its parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/actuator/actuator_model.hpp"
#include "slipwise/actuator/input_history.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/planning/drive_limits.hpp"
#include "slipwise/planning/manoeuvre.hpp"

namespace slipwise {

using ManoeuvreJacobian = Eigen::Matrix<double, 3, kManoeuvreParameters>;

struct ManoeuvreEnd {
  Pose2 pose;                                        ///< observed from the start
  ManoeuvreJacobian by = ManoeuvreJacobian::Zero();  ///< derivative of its chart (x, y, theta)
};

/// The robot on its way: poses observed from the start, and what the drive does at the end.
struct ManoeuvrePath {
  std::vector<double> t = {};     ///< [steps + 1], from 0 on [s]
  std::vector<Pose2> poses = {};  ///< [steps + 1]
  BodyTwist drive = {};
  BodyTwist fast = {};  ///< of the drive, what the lags hold beside the slow ones
};

/// A motion model as a planner uses it. A clock offset is one of measured poses; plans have none.
class PlanningModel {
 public:
  /// The limits lie in front of the actuator.
  /// \throws std::invalid_argument when the parameters do not fit the model, or a limit is none.
  PlanningModel(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                const CommandLimits& limits = {});

  const Basis& basis() const { return basis_; }
  const Eigen::VectorXd& alpha() const { return alpha_; }
  const ActuatorModel& actuator() const { return actuator_; }
  const CommandLimits& limits() const { return limits_; }

 private:
  Basis basis_;
  Eigen::VectorXd alpha_;
  ActuatorModel actuator_;
  CommandLimits limits_;
};

/// Where the robot is when all commands and the settling are over.
Pose2 manoeuvre_pose(const PlanningModel& model, const ManoeuvreFrame& frame, const ManoeuvreVector& parameters,
                     const ActuatorState& start);
/// The way there.
ManoeuvrePath manoeuvre_path(const PlanningModel& model, const ManoeuvreFrame& frame, const ManoeuvreVector& parameters,
                             const ActuatorState& start);
/// Its end with the derivative (derivations/rollouts.md). Limits that ramp are left out of the derivative.
ManoeuvreEnd linearize_manoeuvre(const PlanningModel& model, const ManoeuvreFrame& frame,
                                 const ManoeuvreVector& parameters, const ActuatorState& start);

}  // namespace slipwise
