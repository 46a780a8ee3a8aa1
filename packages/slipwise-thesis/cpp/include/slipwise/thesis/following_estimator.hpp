// SPDX-License-Identifier: Apache-2.0
// An estimator by name on a real log: its prior follows the speeds driven, its noise follows the residuals.
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "slipwise/filter/causal_filter.hpp"
#include "slipwise/filter/driven_speeds.hpp"
#include "slipwise/thesis/estimator.hpp"

namespace slipwise {

class FollowingEstimator {
 public:
  /// Noise shape and IEKF settings are those of `filter`. \throws std::invalid_argument for an unknown name.
  FollowingEstimator(std::string_view name, const MotionModel& model, const CausalFilterSettings& filter,
                     EstimatorSettings settings = {});

  IekfUpdate learn(const InputHistory& inputs, const Segment& segment);

  const MotionModel& model() const { return estimator_.model(); }
  Estimate estimate() const { return estimator_.estimate(); }
  /// As Estimator::running().
  Estimate running() const { return estimator_.running(); }
  /// Standard deviations of the prior now in force, [parameters].
  Eigen::VectorXd prior_std() const;
  /// Learned factor of the noise variances of (x, y, theta).
  Eigen::Vector3d noise_scale() const { return noise_scale_.value(); }

 private:
  void follow();

  CausalFilterSettings settings_;
  ReferenceSpeeds reference_{.v = 1.0, .omega = 1.0};
  DrivenSpeeds driven_;
  NoiseScale noise_scale_;
  Estimator estimator_;
};

}  // namespace slipwise
