// SPDX-License-Identifier: Apache-2.0
// The motion of the pose sensor over a short stretch of time by the estimate, its errors separated by how they last.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "slipwise/disturbance/slip_disturbance.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

using LastingColumns = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Errors of the parameters, and of a slip that is a fraction of the motion, are the same in one leg and the next; what
/// is white is not.
struct MotionLeg {
  Pose2 motion;                                      ///< T_start_end of the pose sensor
  LastingColumns spread;                             ///< derivative by the lasting errors times their covariance,
  LastingColumns by_lasting;                         ///< and the derivative
  Eigen::Matrix3d white;                             ///< covariance of the chart (x, y, theta) by what does not last
  std::shared_ptr<const MotionPosterior> posterior;  ///< whose errors last
  double inputs_until;                               ///< later inputs change nothing [s], by their stamps
  Pose2 sensor;                                      ///< of the pose sensor in base_link

  /// Covariance of the chart by itself.
  Eigen::Matrix3d covariance() const;
};

/// What predicts a leg.
struct LegKnowledge {
  std::shared_ptr<const MotionPosterior> posterior;
  std::shared_ptr<const DisturbanceFilter> disturbance;
  SlipNow slip;      ///< where slip is before the leg
  double inflation;  ///< factor of the covariance
};

/// The leg that `driven` says: its start and end and the inputs.
MotionLeg motion_leg(const LegKnowledge& known, const DrivenSegment& driven);

/// For how long before a leg inputs matter [s].
double leg_memory(const MotionPosterior& posterior);

}  // namespace slipwise
