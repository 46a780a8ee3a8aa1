// SPDX-License-Identifier: Apache-2.0
// How a model that is learned elsewhere predicts segments, under noise whose size is learned.
#pragma once

#include <Eigen/Core>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/noise_scale.hpp"

namespace slipwise {

/// A segment as it was predicted.
struct ScoredSegment {
  Rows innovation;                       ///< measured minus predicted
  RowsCovariance innovation_covariance;  ///< S, parameters and noise
  double nis;                            ///< innovation^T S^-1 innovation
};

/// Scores a model that is learned elsewhere on segments that it has not learned, and learns the size of the noise.
class PredictiveScore {
 public:
  explicit PredictiveScore(const NoiseSettings& settings) : settings_(settings), noise_scale_(settings) {}

  /// Scores the prediction of a segment, then learns the noise from its residual.
  ScoredSegment score(const MotionModel& model, const Estimate& estimate, const InputHistory& inputs,
                      const Segment& segment);
  /// Learned factor of the noise variances of (x, y, theta).
  const Eigen::Vector3d& noise_scale() const { return noise_scale_.value(); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.noise_scale_);
  }

 private:
  NoiseSettings settings_;
  NoiseScale noise_scale_;
};

}  // namespace slipwise
