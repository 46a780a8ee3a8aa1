// SPDX-License-Identifier: Apache-2.0
// Confounded parameters: those whose errors go together.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace slipwise {

/// Two parameters whose errors go together: what they do together is known better than either.
struct CorrelatedPair {
  Eigen::Index first;
  Eigen::Index second;
  double correlation;
};

/// All pairs whose correlation is at least `least` in size, the closest first. A parameter without variance has none.
std::vector<CorrelatedPair> correlated_pairs(const Eigen::Ref<const Eigen::MatrixXd>& covariance, double least);

}  // namespace slipwise
