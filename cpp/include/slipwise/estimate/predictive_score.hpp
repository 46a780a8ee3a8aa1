// SPDX-License-Identifier: Apache-2.0
// How well a model predicts segments: a log score with heavy tails, under noise whose size is learned.
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/estimate/estimate.hpp"
#include "slipwise/estimate/noise_scale.hpp"

namespace slipwise {

/// Student-t log density of an innovation, without constants: real residuals have heavy tails (derivations.md, section
/// 7).
double student_log_score(double nis, const Eigen::Matrix3d& covariance);

/// Log scores of models that predicted the same segment, with innovations [M] of covariances [M], all under one
/// covariance, their mean by weight: a model is judged by its errors, not by how well it knows their size.
/// \throws std::invalid_argument when there is not one of each per weight.
Eigen::VectorXd common_log_scores(const Eigen::VectorXd& weights, std::span<const Eigen::Vector3d> innovations,
                                  std::span<const Eigen::Matrix3d> covariances);

/// A segment as it was predicted.
struct ScoredSegment {
  Eigen::Vector3d innovation;             ///< measured minus predicted chart (x, y, theta)
  Eigen::Matrix3d innovation_covariance;  ///< S, parameters and noise
  double nis;                             ///< innovation^T S^-1 innovation
};

/// Scores a model that is learned elsewhere on segments that it has not learned, and learns the size of the noise.
class PredictiveScore {
 public:
  explicit PredictiveScore(const NoiseSettings& settings) : settings_(settings), noise_scale_(settings) {}

  /// Scores the prediction of a segment, then learns the noise from its residual.
  ScoredSegment score(const MotionModel& model, const Estimate& estimate, const InputTrack& inputs,
                      const Segment& segment);
  /// Learned factor of the noise variances of (x, y, theta).
  const Eigen::Vector3d& noise_scale() const { return noise_scale_.value(); }

 private:
  NoiseSettings settings_;
  NoiseScale noise_scale_;
};

}  // namespace slipwise
