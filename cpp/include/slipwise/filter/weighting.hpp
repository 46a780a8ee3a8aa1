// SPDX-License-Identifier: Apache-2.0
// Weighting candidates by how well they predict: a tempered predictive density (Gruenwald 2012) after a fraction that
// falls with time (Herbster and Warmuth 1998; van Erven, Gruenwald and de Rooij 2012).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "slipwise/linear/rows.hpp"

namespace slipwise {

struct WeightingSettings {
  double learning_rate =
      0.5;                 ///< power of the predictive density: below 1, since no model is true (tempered Bayes) [-]
  double fraction = 0.05;  ///< part of the weight that segment n redistributes, 1/n where that is less: poor candidates
                           ///< lead while data are few, and the longer one has led, the less is a change expected [-]
};

/// The weights after candidates predicted a segment with these log scores, `observed` segments having spoken before;
/// what is redistributed is spread by `prior`, their prior weights (derivations/averaging.md).
/// \throws std::invalid_argument when there is not one score and one prior weight per weight.
Eigen::VectorXd updated_weights(const Eigen::VectorXd& weights, const Eigen::VectorXd& log_scores,
                                const Eigen::VectorXd& prior, const WeightingSettings& settings, std::size_t observed);

/// Log density of an innovation under a Student-t with the scale of its covariance, without constants: real residuals
/// have heavy tails.
double student_log_score(double nis, const RowsCovariance& covariance);

/// Log scores of candidates that predicted the same segment, with innovations [M] of covariances [M], all under one
/// covariance, their mean by weight: a candidate is judged by its errors, not by how well it knows their size.
/// \throws std::invalid_argument when there is not one of each per weight.
Eigen::VectorXd common_log_scores(const Eigen::VectorXd& weights, std::span<const Rows> innovations,
                                  std::span<const RowsCovariance> covariances);

/// The same of predictions, each of which has an `innovation` and an `innovation_covariance`.
template <class Predictions>
Eigen::VectorXd common_log_scores(const Eigen::VectorXd& weights, const Predictions& predictions) {
  std::vector<Rows> innovations;
  std::vector<RowsCovariance> covariances;
  for (const auto& each : predictions) {
    innovations.push_back(each.innovation);
    covariances.push_back(each.innovation_covariance);
  }
  return common_log_scores(weights, innovations, covariances);
}

}  // namespace slipwise
