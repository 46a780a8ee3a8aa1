// SPDX-License-Identifier: Apache-2.0
// The thesis's extended Kalman filter of the slip parameters, Table 6.1 as written, for comparison.
#pragma once

#include <Eigen/Core>

#include "slipwise/thesis/estimator_settings.hpp"

namespace slipwise {

/// Meant to be fed as the thesis does: 20 times a second with overlapping segments of 5 s. Each datum then counts about
/// a hundred times, and the covariance is far too small; `iekf` on disjoint segments is the correct form.
class EkfThesis {
 public:
  EkfThesis(MotionModel model, Estimate prior, const EstimatorSettings& settings);

  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);
  const MotionModel& model() const { return model_; }
  Estimate estimate() const { return estimate_; }
  /// The same data under another slip prior; false, and nothing done, where the posterior is too ill-conditioned.
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std);
  /// Does nothing: the thesis's measurement noise is given, not learned.
  void scale_noise(const Eigen::Vector3d&) {}

 private:
  MotionModel model_;
  EkfThesisSettings settings_;
  MotionNoise noise_;
  Estimate estimate_;
  Eigen::VectorXd prior_variance_;
};

}  // namespace slipwise
