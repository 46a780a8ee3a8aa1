// SPDX-License-Identifier: Apache-2.0
// The off-line fit behind the interface of the on-line estimators: it keeps all segments and fits them when asked.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/thesis/iekf_estimator.hpp"

namespace slipwise {

/// An IEKF runs along, so that there is a posterior to go on from before the fit. Memory grows with the segments.
class BatchEstimator {
 public:
  BatchEstimator(MotionModel model, Estimate prior, const EstimatorSettings& settings);

  /// Keeps the segment; the update is that of the filter that runs along.
  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);
  const MotionModel& model() const { return filter_.model(); }
  /// The MAP fit over all segments, made again by each call; before the first segment, the prior.
  Estimate estimate() const;
  /// The posterior of the filter that runs along.
  Estimate running() const { return filter_.estimate(); }
  /// The same data under another slip prior; false, and nothing done, where the filter's posterior is too
  /// ill-conditioned.
  bool change_prior(const Eigen::VectorXd& old_std, const Eigen::VectorXd& new_std);
  /// Factor of the noise variances of (x, y, theta), of all segments.
  void scale_noise(const Eigen::Vector3d& scale);

 private:
  struct Kept {
    InputHistory inputs;
    Segment segment;
  };

  IekfEstimator filter_;
  Estimate prior_;
  MotionNoise noise_;
  double huber_;
  Eigen::Vector3d scale_ = Eigen::Vector3d::Ones();
  std::vector<Kept> kept_;
};

}  // namespace slipwise
