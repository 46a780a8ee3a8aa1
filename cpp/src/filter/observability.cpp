// SPDX-License-Identifier: Apache-2.0
// Posterior against prior, in units of the prior (derivations/filter.md).
#include "slipwise/filter/observability.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "slipwise/linear/symmetric_eigen.hpp"

namespace slipwise {

Observability observability(const Estimate& posterior, const Eigen::Ref<const Eigen::VectorXd>& prior_std) {
  if (prior_std.size() != posterior.covariance.rows() || !(prior_std.array() > 0.0).all()) {
    throw std::invalid_argument("observability needs one positive prior standard deviation per parameter");
  }
  if (prior_std.size() == 0) {
    return {.ratio = {}, .weakest = {}, .weakest_ratio = 0.0};
  }
  const Eigen::VectorXd inverse = prior_std.cwiseInverse();
  const Eigen::MatrixXd relative = inverse.asDiagonal() * posterior.covariance * inverse.asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(relative);
  const Eigen::Index last = prior_std.size() - 1;
  return {.ratio = relative.diagonal(), .weakest = eigen.vectors.col(last), .weakest_ratio = eigen.values[last]};
}

std::vector<CorrelatedPair> correlated_pairs(const Eigen::Ref<const Eigen::MatrixXd>& covariance, double least) {
  std::vector<CorrelatedPair> pairs;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < covariance.cols(); ++j) {
      const double both = covariance(i, i) * covariance(j, j);
      const double correlation = both > 0.0 ? covariance(i, j) / std::sqrt(both) : 0.0;
      if (std::abs(correlation) >= least) {
        pairs.push_back({.first = i, .second = j, .correlation = correlation});
      }
    }
  }
  std::ranges::stable_sort(pairs, std::greater{}, [](const CorrelatedPair& p) { return std::abs(p.correlation); });
  return pairs;
}

}  // namespace slipwise
