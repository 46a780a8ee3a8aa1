// SPDX-License-Identifier: Apache-2.0
// Variances of lags among candidates: a mixture, and the tops of parabolas between them.
#include "slipwise/identify/lag_variance.hpp"

#include <algorithm>

namespace slipwise {

double lag_variance(std::span<const double> lags, const Eigen::VectorXd& logarithm, std::size_t best) {
  const Eigen::VectorXd odds = (logarithm.array() - logarithm.maxCoeff()).exp();
  double others = 0.0;
  for (std::size_t k = 0; k < lags.size(); ++k) {
    others += odds[static_cast<Eigen::Index>(k)] / odds.sum() * (lags[k] - lags[best]) * (lags[k] - lags[best]);
  }
  const double width = (lags[std::min(best + 1, lags.size() - 1)] - lags[best > 0 ? best - 1 : 0]) / 2.0;
  const double between = width * width / 3.0;
  if (best == 0 || best + 1 == lags.size()) {
    return others + between;
  }
  const auto k = static_cast<Eigen::Index>(best);
  const double before = lags[best - 1] - lags[best], after = lags[best + 1] - lags[best];
  const double low = (logarithm[k - 1] - logarithm[k]) / before, high = (logarithm[k + 1] - logarithm[k]) / after;
  const double bend = (high - low) / (after - before);  // of bend x^2 + slope x
  if (!(bend < 0.0)) {
    return others + between;
  }
  const double off = -0.5 * (low - bend * before) / bend;
  return others + std::min(off * off - 0.5 / bend, between);
}

double prior_lag_variance(std::span<const double> lags) {
  double mean = 0.0, square = 0.0;
  for (const double lag : lags) {
    mean += lag / static_cast<double>(lags.size());
    square += lag * lag / static_cast<double>(lags.size());
  }
  return square - mean * mean;
}

}  // namespace slipwise
