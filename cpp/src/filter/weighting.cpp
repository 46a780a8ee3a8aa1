// SPDX-License-Identifier: Apache-2.0
// Tempered, shared Bayes over candidates.
#include "slipwise/filter/weighting.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slipwise/filter/heavy_tails.hpp"

namespace slipwise {

Eigen::VectorXd updated_weights(const Eigen::VectorXd& weights, const Eigen::VectorXd& log_scores,
                                const Eigen::VectorXd& prior, const WeightingSettings& settings, std::size_t observed) {
  if (weights.size() != log_scores.size() || weights.size() != prior.size() || weights.size() == 0) {
    throw std::invalid_argument("each candidate needs a weight, a log score and a prior weight, got " +
                                std::to_string(weights.size()) + ", " + std::to_string(log_scores.size()) + " and " +
                                std::to_string(prior.size()));
  }
  // Shared before the segment speaks, not after: what is spread to candidates that it refutes never reaches a
  // prediction.
  const double fraction = std::min(settings.fraction, 1.0 / static_cast<double>(observed + 1));
  const Eigen::ArrayXd shared = (1.0 - fraction) * weights.array() + fraction * prior.array();
  const Eigen::ArrayXd tempered = settings.learning_rate * (log_scores.array() - log_scores.maxCoeff());
  const Eigen::VectorXd heavier = shared * tempered.exp();
  return heavier / heavier.sum();
}

namespace {

bool three(const RowsCovariance& covariance) {
  return covariance.rows() == 3;
}  // that most segments have: by cofactors

double determinant_of(const RowsCovariance& covariance) {
  return three(covariance) ? Eigen::Matrix3d(covariance).determinant() : covariance.determinant();
}

RowsCovariance inverse_of(const RowsCovariance& covariance) {
  return three(covariance) ? RowsCovariance(Eigen::Matrix3d(covariance).inverse())
                           : RowsCovariance(covariance.inverse());
}

}  // namespace

double student_log_score(double nis, const RowsCovariance& covariance) {
  return -0.5 * std::log(determinant_of(covariance)) - 0.5 * (kTailDegrees + 3.0) * std::log1p(nis / kTailDegrees);
}

Eigen::VectorXd common_log_scores(const Eigen::VectorXd& weights, std::span<const Rows> innovations,
                                  std::span<const RowsCovariance> covariances) {
  if (std::ssize(innovations) != weights.size() || std::ssize(covariances) != weights.size()) {
    throw std::invalid_argument("each weight needs an innovation and a covariance");
  }
  RowsCovariance covariance;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    if (i == 0) {
      covariance.setZero(covariances[i].rows(), covariances[i].rows());
    }
    if (covariances[i].rows() != covariance.rows() || innovations[i].size() != covariance.rows()) {
      throw std::invalid_argument("candidates must predict the same rows");
    }
    covariance += weights[static_cast<Eigen::Index>(i)] * covariances[i];
  }
  const RowsCovariance precision = inverse_of(covariance);
  Eigen::VectorXd scores(weights.size());
  for (std::size_t i = 0; i < innovations.size(); ++i) {
    const double nis = innovations[i].dot(precision * innovations[i]);
    scores[static_cast<Eigen::Index>(i)] = student_log_score(nis, covariance);
  }
  return scores;
}

}  // namespace slipwise
