// SPDX-License-Identifier: Apache-2.0
// The sandwich estimator with scores that are correlated in time, as sums that need no segment twice.
#include "slipwise/filter/score_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

/// Residuals as many as the noise model counts for: fewer, and a few segments that say much and fit by chance look as
/// if they knew more than they do.
SLIPWISE_TUNING(kModelSegments, 20.0);
SLIPWISE_TUNING(kKernelTime, 16.0);      // [s] scores so far apart count for 1/e in the sum of their correlations
SLIPWISE_TUNING(kMostTaken, 0.6);        // largest fraction of a correlation that the fitted mean is taken to remove
SLIPWISE_TUNING(kFewCorrelations, 2.0);  // covariance inflation per unit of kernel time over learned time
SLIPWISE_TUNING(kLeast, 0.4);            // factor of the variances by correlations, where these are negative

/// tr(A_gg B_gg).
double block_trace(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const std::vector<Eigen::Index>& group) {
  double sum = 0.0;
  for (const Eigen::Index column : group) {
    for (const Eigen::Index row : group) {
      sum += a(row, column) * b(row, column);
    }
  }
  return sum;
}

/// Noise^-1 J, by factors that are compiled elsewhere.
RowsJacobian weighted_by(const RowsCovariance& noise, const RowsJacobian& jacobian) {
  return solve_innovation(noise, jacobian);
}
Eigen::MatrixXd weighted_by(const Eigen::MatrixXd& noise, const Eigen::MatrixXd& jacobian) {
  return Cholesky(noise).solve(jacobian);
}

}  // namespace

ScoreCovariance::ScoreCovariance(const MotionModel& model) : groups_(kChannels + 1) {
  for (Eigen::Index i = 0; i < model.size(); ++i) {
    const bool slip = i < model.slip_size();
    const auto group = slip ? static_cast<std::size_t>(model.basis().channel(static_cast<std::size_t>(i))) : kChannels;
    groups_[group].push_back(i);
  }
  std::erase_if(groups_, [](const auto& group) { return group.empty(); });
  earlier_.resize(model.size());
  restart();
}

ScoreCovariance::ScoreCovariance(std::vector<std::vector<Eigen::Index>> groups, Eigen::Index size)
    : groups_(std::move(groups)), earlier_(size) {
  restart();
}

void ScoreCovariance::restart() {
  const Eigen::Index size = earlier_.size();
  information_ = scatter_ = lagged_ = Eigen::MatrixXd::Zero(size, size);
  earlier_.setZero();
  segments_ = earlier_weight_ = pairs_ = time_ = 0.0;
}

void ScoreCovariance::add(const SegmentLinearization& at, const Eigen::MatrixXd& covariance, const Segment& segment,
                          const RowsCovariance& noise) {
  const Rows residual = error_of(segment, at);
  add_score(at.by_parameter, residual, covariance, noise, (segment.start + segment.end) / 2.0);
}

void ScoreCovariance::add(const MeasurementScore& measured) {
  add_score(measured.jacobian, measured.residual, measured.covariance, measured.noise, measured.t);
}

template <class Jacobian, class Residual, class Noise>
void ScoreCovariance::add_score(const Jacobian& jacobian, const Residual& residual, const Eigen::MatrixXd& covariance,
                                const Noise& noise, double middle) {
  if (jacobian.isZero(0.0)) {
    return;
  }
  const Noise square = residual * residual.transpose() + jacobian * covariance * jacobian.transpose();
  const Jacobian weighted = weighted_by(noise, jacobian);
  const Eigen::VectorXd score = weighted.transpose() * residual;
  const double age = middle - time_;
  const double decay = age >= 0.0 ? std::exp(-age / kKernelTime) : 0.0;  // time goes back where a new run begins
  earlier_ *= decay;
  earlier_weight_ *= decay;
  information_ += weighted.transpose() * jacobian;
  scatter_ += weighted.transpose() * square * weighted;
  lagged_ += score * earlier_.transpose();
  pairs_ += earlier_weight_;
  earlier_ += score;
  earlier_weight_ += 1.0;
  segments_ += 1.0;
  time_ = middle;
}

/// Of the variances of one group, as far as they come from the segments.
double ScoreCovariance::factor(const std::vector<Eigen::Index>& group, const Eigen::MatrixXd& covariance,
                               double correlation_time) const {
  const double information = block_trace(covariance, information_, group);
  const double scatter = block_trace(covariance, scatter_, group);
  if (!(scatter > 0.0)) {
    return 1.0;
  }
  const double expected = (segments_ * scatter + kModelSegments * information) / (segments_ + kModelSegments);
  const double taken = std::min(2.0 * pairs_ / (segments_ * segments_), kMostTaken);
  const double lagged = 2.0 * block_trace(covariance, lagged_, group) / scatter;
  const double correlation = (lagged + taken) / (1.0 - taken);
  const double gain = (1.0 + correlation_time / kKernelTime) * (1.0 + kFewCorrelations * taken);
  return expected / information * std::max(1.0 + gain * correlation, kLeast);
}

Eigen::VectorXd ScoreCovariance::std_factors(const Eigen::MatrixXd& prior, const Eigen::MatrixXd& covariance,
                                             double correlation_time) const {
  if (groups_.empty()) {
    return {};
  }
  const Eigen::MatrixXd by_prior = Cholesky(prior).solve(covariance);
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(covariance.rows());
  for (const auto& group : groups_) {
    const double of_segments = factor(group, covariance, correlation_time);
    for (const Eigen::Index i : group) {
      const double of_prior = std::clamp(covariance.col(i).dot(by_prior.col(i)) / covariance(i, i), 0.0, 1.0);
      factors[i] = std::sqrt(of_prior + (1.0 - of_prior) * of_segments);
    }
  }
  return factors;
}

}  // namespace slipwise
