// SPDX-License-Identifier: Apache-2.0
// Scoring predictions of segments.
#include "slipwise/estimate/predictive_score.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "slipwise/estimate/heavy_tails.hpp"

namespace slipwise {

double student_log_score(double nis, const Eigen::Matrix3d& covariance) {
  return -0.5 * std::log(covariance.determinant()) - 0.5 * (kTailDegrees + 3.0) * std::log1p(nis / kTailDegrees);
}

Eigen::VectorXd common_log_scores(const Eigen::VectorXd& weights, std::span<const Eigen::Vector3d> innovations,
                                  std::span<const Eigen::Matrix3d> covariances) {
  if (std::ssize(innovations) != weights.size() || std::ssize(covariances) != weights.size()) {
    throw std::invalid_argument("each weight needs an innovation and a covariance");
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    covariance += weights[static_cast<Eigen::Index>(i)] * covariances[i];
  }
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  Eigen::VectorXd scores(weights.size());
  for (std::size_t i = 0; i < innovations.size(); ++i) {
    const double nis = innovations[i].dot(factor.solve(innovations[i]));
    scores[static_cast<Eigen::Index>(i)] = student_log_score(nis, covariance);
  }
  return scores;
}

ScoredSegment PredictiveScore::score(const MotionModel& model, const Estimate& estimate, const InputTrack& inputs,
                                     const Segment& segment) {
  const auto at = linearize_segment(model, estimate.mean, inputs, segment);
  const Eigen::Matrix3d open = at.by_parameter * estimate.covariance * at.by_parameter.transpose();
  const Eigen::Matrix3d expected =
      slip_covariance(at.path, settings_.shape) + pose_noise_covariance(at.predicted, settings_.shape);
  const Eigen::Matrix3d covariance = open + scaled_covariance(expected, noise_scale_.value());
  const Eigen::Vector3d innovation = segment.measured.vector() - at.predicted.vector();
  noise_scale_.learn_prediction(innovation.cwiseAbs2(), open.diagonal(), expected.diagonal());
  return {innovation, covariance, innovation.dot(covariance.llt().solve(innovation))};
}

}  // namespace slipwise
