// SPDX-License-Identifier: Apache-2.0
// Parameters whose errors go together (derivations/filter.md).
#include "slipwise/filter/observability.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace slipwise {

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
