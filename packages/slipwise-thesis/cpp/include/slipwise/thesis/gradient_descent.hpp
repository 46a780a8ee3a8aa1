// SPDX-License-Identifier: Apache-2.0
// Gradient descent on the residual of one segment after another (thesis 6.2, (6.12)).
#pragma once

#include <Eigen/Core>

#include "slipwise/thesis/estimator_settings.hpp"

namespace slipwise {

/// p += gamma W J^T (J W J^T + l I)^-1 (X_measured - X_predicted). Erratum of (6.6): a 3 x 15 matrix has no inverse;
/// this is the damped pseudo-inverse in the metric W, the prior's variances, which gives parameters of different units
/// their sizes. The method has no covariance: its estimate's covariance stays the prior's.
class GradientDescent {
 public:
  GradientDescent(MotionModel model, Estimate prior, const EstimatorSettings& settings);

  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);
  const MotionModel& model() const { return model_; }
  Estimate estimate() const { return estimate_; }
  /// The same data under another slip prior; false, and nothing done, where the posterior is too ill-conditioned.
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std);
  /// Does nothing: the step does not depend on the noise.
  void scale_noise(const Eigen::Vector3d&) {}

 private:
  MotionModel model_;
  GradientDescentSettings settings_;
  Estimate estimate_;
};

}  // namespace slipwise
