// SPDX-License-Identifier: Apache-2.0
// The covariance of an estimator under the residuals that it left, beside the one under the noise that it was told.
#include "slipwise/estimate/sandwich.hpp"

#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

/// Residuals as many as the stated noise counts for: fewer, and a few segments that tell much and fit by chance look
/// as if they knew more than they do.
constexpr double kStated = 20.0;

}  // namespace

Eigen::VectorXd sandwich_factors(const Estimate& before, const BatchFit& fit, std::span<const BatchDatum> data) {
  const Eigen::MatrixXd& bread = fit.estimate.covariance;
  const auto count = static_cast<double>(data.size());
  Eigen::MatrixXd filling = Cholesky(before.covariance).inverse();
  for (std::size_t i = 0; i < data.size(); ++i) {
    const BatchDatum& datum = data[i];
    const SegmentLinearization& at = fit.at[i];
    const Eigen::Vector3d residual = datum.segment.measured.vector() - at.predicted.vector();
    const Eigen::Matrix3d open = at.by_parameter * bread * at.by_parameter.transpose();
    const Eigen::Matrix3d seen = residual * residual.transpose() + open;
    const Eigen::Matrix3d noise = (count * seen + kStated * datum.noise) / (count + kStated);
    const Eigen::MatrixXd weighed = Cholesky(datum.noise).solve(at.by_parameter);
    filling += weighed.transpose() * noise * weighed;
  }
  const Eigen::VectorXd variance = (bread * filling * bread).diagonal();
  return variance.cwiseQuotient(bread.diagonal()).cwiseSqrt();
}

}  // namespace slipwise
