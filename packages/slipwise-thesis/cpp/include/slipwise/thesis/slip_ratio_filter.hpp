// SPDX-License-Identifier: Apache-2.0
// Slip ratios and slip angle learned by an extended Kalman filter over segments (thesis 2.5 to 2.7), as a candidate.
#pragma once

#include <Eigen/Core>

#include "slipwise/actuator/input_history.hpp"
#include "slipwise/filter/estimate.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/segment.hpp"
#include "slipwise/segment/segment_covariance.hpp"
#include "slipwise/thesis/slip_ratios.hpp"

namespace slipwise {

inline constexpr double kNominalWheelSeparation = 0.6;  ///< the default: of a robot the size of a Husky [m]

/// full-linear-6 behind an identity actuator: what slip ratios are predicted with.
MotionModel slip_ratio_model();

struct SlipRatioLinearization {
  SegmentLinearization segment;    ///< by the parameters of full-linear-6
  Eigen::Matrix3d by_slip_ratios;  ///< derivative of the predicted chart by (left, right, angle)
};

/// A segment as predicted from wheel speeds with constant slip ratios, and its derivative.
SlipRatioLinearization linearize_slip_ratios(const InputHistory& wheels, const Segment& segment, const SlipRatios& slip,
                                             double wheel_separation);

struct SlipRatioFilterSettings {
  double wheel_separation = kNominalWheelSeparation;  ///< between the two sides [m]
  double prior_ratio_std = 0.3;                       ///< of each slip ratio before any data [-]
  double prior_angle_std = 0.2;                       ///< of the slip angle before any data [rad]
  double walk_ratio = 0.01;                           ///< random walk of each slip ratio while driving [1/sqrt(s)]
  double walk_angle = 0.005;                          ///< random walk of the slip angle while driving [rad/sqrt(s)]
  double huber = 2.5;                                 ///< a residual of more than this many sigma counts for less [-]
  MotionNoise noise = {};                             ///< of a segment's measurement
};

/// One segment's update.
struct SlipRatioUpdate {
  Eigen::Vector3d innovation;             ///< measured minus predicted chart, before the update
  Eigen::Matrix3d innovation_covariance;  ///< S before the update
  double nis;                             ///< innovation^T S^-1 innovation
  double weight;                          ///< Huber weight
};

class SlipRatioFilter {
 public:
  /// \throws std::invalid_argument when the wheel separation, a standard deviation or the pose noise is not positive.
  explicit SlipRatioFilter(const SlipRatioFilterSettings& settings);

  /// Lets the slip walk for the segment's duration, then learns it. Only time inside segments counts, so that a parked
  /// robot forgets nothing. \throws std::invalid_argument when the segment ends before it starts or is not finite.
  SlipRatioUpdate learn(const InputHistory& wheels, const Segment& segment);

  SlipRatios slip() const { return SlipRatios::from_vector(estimate_.mean); }
  /// Posterior of (left, right, angle).
  const Estimate& estimate() const { return estimate_; }
  /// The same posterior about the parameters of full-linear-6; its covariance has rank 3.
  Estimate linear_estimate() const;

 private:
  SlipRatioFilterSettings settings_;
  Estimate estimate_;
};

}  // namespace slipwise
