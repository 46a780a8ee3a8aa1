// SPDX-License-Identifier: Apache-2.0
// Iterated extended Kalman filter over disjoint segments (derivations/filter.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/map_update.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

struct IekfSettings {
  int iterations = 10;      ///< Gauss-Newton iterations per segment, at most; two are nominal once the prior is tight
  double tolerance = 1e-2;  ///< iterations stop when they lower the MAP cost (in units of NIS) by less than this [-]
  int halvings = 4;         ///< step halvings per iteration before the iteration is given up
  double huber = 2.5;       ///< a residual of more than this many sigma counts for less [-]
  double gate = 50.0;       ///< NIS (3 degrees of freedom) beyond which a segment is rejected [-]

  MapSettings map() const { return {.iterations = iterations, .tolerance = tolerance, .halvings = halvings}; }
  /// Huber weight of a residual: 1 where nothing is unusual, 0 where it is rejected; its noise is divided by that.
  double weight(double nis) const;
};

/// One segment's update.
struct IekfUpdate {
  Estimate estimate;                     ///< after the segment
  Rows innovation;                       ///< measured minus predicted, before the update
  RowsCovariance innovation_covariance;  ///< S = J P J^T + R before the update
  double nis;                            ///< innovation^T S^-1 innovation
  double weight;                         ///< Huber weight, 1 where nothing was unusual, 0 where rejected
  Status status;
  SegmentLinearization at = {};  ///< at the estimate's mean, as `iekf_update` returns it
  /// What the actuator bends away from its linearisation: added to the noise where the covariance learns.
  RowsCovariance bent = {};

  /// Says by the NIS what the segment counts.
  void weigh(const IekfSettings& settings);
};

/// `noise` is the covariance R of what was measured of the segment. \throws std::invalid_argument when sizes do not
/// fit.
IekfUpdate iekf_update(const MotionModel& model, const Estimate& prior, const InputHistory& inputs,
                       const Segment& segment, const RowsCovariance& noise, const IekfSettings& settings = {});
/// The same where the segment is linearised at the prior's mean already, as its noise may need.
IekfUpdate iekf_update(const MotionModel& model, const Estimate& prior, const InputHistory& inputs,
                       const Segment& segment, SegmentLinearization at_prior, const RowsCovariance& noise,
                       const IekfSettings& settings = {});

/// Covariance in the coordinates of times after their means moved from `before` (derivations/filter.md).
void follow_times(const MotionModel& model, const Eigen::VectorXd& before, Estimate& estimate);

}  // namespace slipwise
