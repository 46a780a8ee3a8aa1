// SPDX-License-Identifier: Apache-2.0
// Scoring predictions of segments.
#include "slipwise/estimate/predictive_score.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "slipwise/estimate/causal_filter.hpp"
#include "slipwise/estimate/heavy_tails.hpp"

namespace slipwise {

double student_log_score(double nis, const Eigen::Matrix3d& covariance) {
  return -0.5 * std::log(covariance.determinant()) - 0.5 * (kTailDegrees + 3.0) * std::log1p(nis / kTailDegrees);
}

ScoredSegment PredictiveScore::score(const MotionModel& model, const Estimate& estimate, const InputTrack& inputs,
                                     const Segment& segment) {
  const auto at = linearize_segment(model, estimate.mean, inputs, segment);
  const Eigen::Matrix3d covariance =
      prediction_covariance(at, estimate.covariance, settings_.shape, noise_scale_.value());
  const Eigen::Vector3d innovation = segment.measured.vector() - at.predicted.vector();
  const double nis = innovation.dot(covariance.llt().solve(innovation));
  const Eigen::Matrix3d expected =
      slip_covariance(at.path, settings_.shape) + pose_noise_covariance(at.predicted, settings_.shape);
  const Eigen::Matrix3d open = at.by_parameter * estimate.covariance * at.by_parameter.transpose();
  noise_scale_.learn_prediction(innovation.cwiseAbs2(), open.diagonal(), expected.diagonal());
  return {innovation, covariance, nis, student_log_score(nis, covariance)};
}

}  // namespace slipwise
