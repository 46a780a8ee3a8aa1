// SPDX-License-Identifier: Apache-2.0
// Slip ratios and slip angle by a sliding-mode observer with boundary layers (thesis 2.5 to 2.7), as a candidate.
#pragma once

#include <Eigen/Core>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/segment/segment.hpp"
#include "slipwise/thesis/slip_ratio_filter.hpp"
#include "slipwise/thesis/slip_ratios.hpp"

namespace slipwise {

/// The sliding surfaces are the measured minus the predicted mean speed of the left side, of the right side and to the
/// left. Outside its boundary layer a surface moves its slip at the full gain; inside, in proportion. A layer widens by
/// twice what the slip may move in one segment, so that a step never overshoots and the observer does not chatter.
struct SlidingModeSettings {
  double wheel_separation = kNominalWheelSeparation;  ///< between the two sides [m]
  double ratio_gain = 0.05;                           ///< largest rate of a slip ratio [1/s]
  double angle_gain = 0.025;                          ///< largest rate of the slip angle [rad/s]
  double side_layer = 0.05;                           ///< boundary layer of the side speeds at standstill [m/s]
  double drift_layer = 0.05;                          ///< boundary layer of the sideways speed at standstill [m/s]
  double slowest = 0.02;  ///< a side, or the robot, that is slower teaches its slip nothing [m/s]
};

/// What a segment says to the observer.
struct SlidingModeUpdate {
  Eigen::Vector3d surface;  ///< of the left side, the right side and the drift, before the update [m/s]
  bool used;                ///< false: the segment turns by nearly half a turn or more, and its mean speed is unclear
};

class SlidingModeObserver {
 public:
  /// \throws std::invalid_argument when a setting is not positive.
  explicit SlidingModeObserver(const SlidingModeSettings& settings);

  /// Learns one segment. \throws std::invalid_argument when it ends before it starts or is not finite.
  SlidingModeUpdate learn(const InputHistory& wheels, const Segment& segment);

  const SlipRatios& slip() const { return slip_; }
  /// The slip as parameters of full-linear-6. There is no covariance: the observer has none.
  Eigen::VectorXd linear_mean() const { return linear_slip(slip_, settings_.wheel_separation).alpha; }

 private:
  SlidingModeSettings settings_;
  SlipRatios slip_;
};

}  // namespace slipwise
