// SPDX-License-Identifier: Apache-2.0
// Learning one model segment by segment: prior that follows the speeds, IEKF update, noise that follows the residuals.
#pragma once

#include <Eigen/Core>

#include "slipwise/estimate/iekf.hpp"
#include "slipwise/estimate/noise_scale.hpp"
#include "slipwise/estimate/prior.hpp"
#include "slipwise/estimate/speed_range.hpp"

namespace slipwise {

struct CausalFilterSettings {
  PriorSettings prior = {};
  IekfSettings iekf = {};
  NoiseSettings noise = {};
};

class CausalFilter {
 public:
  CausalFilter(MotionModel model, const CausalFilterSettings& settings);

  /// Learns one segment. `speeds` are those seen up to the segment's end.
  IekfUpdate learn(const InputTrack& inputs, const Segment& segment, const ReferenceSpeeds& speeds);

  /// Gives the slip parameters `share` of their prior variance back and keeps their mean. Lag, delay and clock are the
  /// robot's, not the ground's: they stay as learned.
  void forget(double share);

  const MotionModel& model() const { return model_; }
  const Estimate& estimate() const { return estimate_; }
  /// Standard deviations of the prior now in force, [parameters].
  Eigen::VectorXd prior_std() const;
  /// Learned factor of the noise variances of (x, y, theta).
  Eigen::Vector3d noise_scale() const { return noise_scale_.value(); }
  const NoiseSettings& noise() const { return settings_.noise; }

 private:
  void follow(const ReferenceSpeeds& speeds);

  MotionModel model_;
  CausalFilterSettings settings_;
  ReferenceSpeeds speeds_{};
  bool started_ = false;
  Estimate estimate_;
  Eigen::VectorXd slip_std_;
  NoiseScale noise_scale_;
};

/// Covariance of a predicted chart: parameters, slip noise and, where `with_pose_noise`, the two measured poses.
Eigen::Matrix3d prediction_covariance(const SegmentLinearization& at,
                                      const Eigen::Ref<const Eigen::MatrixXd>& parameters, const MotionNoise& shape,
                                      const Eigen::Vector3d& scale);

}  // namespace slipwise
