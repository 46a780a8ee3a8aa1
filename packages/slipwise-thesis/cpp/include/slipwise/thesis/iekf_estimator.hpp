// SPDX-License-Identifier: Apache-2.0
// The iterated extended Kalman filter as an estimator: disjoint segments, each with the noise of its own path.
#pragma once

#include <Eigen/Core>

#include "slipwise/thesis/estimator_settings.hpp"

namespace slipwise {

class IekfEstimator {
 public:
  IekfEstimator(MotionModel model, Estimate prior, const EstimatorSettings& settings);

  /// Segments must not overlap. That neighbours share a pose is not modelled; `delayed-state` does.
  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);
  const MotionModel& model() const { return model_; }
  Estimate estimate() const { return estimate_; }
  /// The same data under another slip prior; false, and nothing done, where the posterior is too ill-conditioned.
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std);
  /// Factor of the noise variances of (x, y, theta).
  void scale_noise(const Eigen::Vector3d& scale) { scale_ = scale; }

 private:
  MotionModel model_;
  IekfSettings settings_;
  MotionNoise noise_;
  Estimate estimate_;
  Eigen::Vector3d scale_ = Eigen::Vector3d::Ones();
};

}  // namespace slipwise
