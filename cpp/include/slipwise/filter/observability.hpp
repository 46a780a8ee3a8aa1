// SPDX-License-Identifier: Apache-2.0
// What the data say of each parameter: posterior against prior, the direction known least, and confounded parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/filter/estimate.hpp"

namespace slipwise {

struct Observability {
  Eigen::VectorXd ratio;    ///< posterior variance / prior variance per parameter; 1: nothing learned
  Eigen::VectorXd weakest;  ///< unit vector, in prior standard deviations: the combination known least
  double weakest_ratio;     ///< its posterior / prior variance
};

/// \throws std::invalid_argument when sizes differ or a prior standard deviation is not positive.
Observability observability(const Estimate& posterior, const Eigen::Ref<const Eigen::VectorXd>& prior_std);

/// Two parameters whose errors go together: what they do together is known better than either.
struct CorrelatedPair {
  Eigen::Index first;
  Eigen::Index second;
  double correlation;
};

/// All pairs whose correlation is at least `least` in size, the closest first. A parameter without variance has none.
std::vector<CorrelatedPair> correlated_pairs(const Eigen::Ref<const Eigen::MatrixXd>& covariance, double least);

}  // namespace slipwise
