// SPDX-License-Identifier: Apache-2.0
// Bayesian linear regression with rank-one updates of the information's Cholesky factor.
#include "slipwise/thesis/bayesian_regression.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slipwise/linear/cholesky.hpp"

namespace slipwise {
namespace {

constexpr double kRounding = 1e-9;  // of the information: what is lost below this is rounding

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

/// Whether `part` is positive semi-definite up to rounding, in units of `whole`'s diagonal.
bool semi_definite(const Eigen::MatrixXd& part, const Eigen::VectorXd& whole) {
  const Eigen::VectorXd inverse = whole.cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd relative = inverse.asDiagonal() * part * inverse.asDiagonal();
  relative.diagonal().array() += kRounding;
  return Cholesky(relative).positive_definite();
}

}  // namespace

double RegressionPrediction::std() const {
  if (std::isinf(freedom)) {
    return scale;
  }
  return freedom > 2.0 ? scale * std::sqrt(freedom / (freedom - 2.0)) : std::numeric_limits<double>::infinity();
}

BayesianRegression::BayesianRegression(RegressionPrior prior) : prior_(std::move(prior)) {
  if (!std::ranges::all_of(prior_.weight_std, positive) || !positive(prior_.noise_std)) {
    throw std::invalid_argument("a regression needs positive prior standard deviations of weights and noise");
  }
  if (!(prior_.noise_examples > 0.0)) {
    throw std::invalid_argument("the noise stated before must be worth a positive number of examples");
  }
  information_ = (prior_.noise_std * prior_.weight_std.cwiseInverse()).cwiseAbs2().asDiagonal();
  evidence_ = Eigen::VectorXd::Zero(prior_.weight_std.size());
  factor_.compute(information_);
  refresh_mean();
}

void BayesianRegression::check(const RegressionExample& example) const {
  if (example.features.size() != evidence_.size()) {
    throw std::invalid_argument("an example needs " + std::to_string(evidence_.size()) + " features, not " +
                                std::to_string(example.features.size()));
  }
  if (!example.features.allFinite() || !std::isfinite(example.output) || !positive(example.relative_std)) {
    throw std::invalid_argument("an example must be finite and have a positive standard deviation");
  }
}

void BayesianRegression::add(const RegressionExample& example) {
  check(example);
  const double weight = 1.0 / (example.relative_std * example.relative_std);
  const double error = example.output - example.features.dot(mean_);
  const double spread = example.features.dot(factor_.solve(example.features));
  information_ += weight * example.features * example.features.transpose();
  evidence_ += weight * example.output * example.features;
  factor_.rankUpdate(example.features, weight);
  misfit_ += error * error * weight / (1.0 + weight * spread);
  ++count_;
  refresh_mean();
}

void BayesianRegression::remove(const RegressionExample& example) {
  check(example);
  BayesianRegression rest = *this;
  const double weight = 1.0 / (example.relative_std * example.relative_std);
  rest.information_ -= weight * example.features * example.features.transpose();
  rest.evidence_ -= weight * example.output * example.features;
  rest.factor_.compute(rest.information_);
  const BayesianRegression before(prior_);
  if (count_ == 0 || rest.factor_.info() != Eigen::Success ||
      !semi_definite(rest.information_ - before.information_, information_.diagonal())) {
    throw std::invalid_argument(
        "the example cannot be removed: less than nothing would be known without it; was it added?");
  }
  rest.refresh_mean();
  const double error = example.output - example.features.dot(rest.mean_);
  const double spread = example.features.dot(rest.factor_.solve(example.features));
  rest.misfit_ -= error * error * weight / (1.0 + weight * spread);
  if (rest.misfit_ < -kRounding * (misfit_ + error * error * weight)) {
    throw std::invalid_argument("the example cannot be removed: it fits worse than all that was added; was it added?");
  }
  rest.misfit_ = std::max(rest.misfit_, 0.0);
  --rest.count_;
  *this = rest.count_ == 0 ? before : rest;
}

BayesianRegression BayesianRegression::merged(const BayesianRegression& other) const {
  if (prior_.weight_std != other.prior_.weight_std || prior_.noise_std != other.prior_.noise_std ||
      prior_.noise_examples != other.prior_.noise_examples) {
    throw std::invalid_argument("only regressions with the same prior can be merged; the prior counts once");
  }
  BayesianRegression whole(prior_);
  const Eigen::MatrixXd prior_information = whole.information_;
  whole.information_ = information_ + other.information_ - prior_information;
  whole.evidence_ = evidence_ + other.evidence_;
  whole.factor_.compute(whole.information_);
  whole.refresh_mean();
  const auto misfit_at = [&whole](const BayesianRegression& part) {
    const Eigen::VectorXd off = whole.mean_ - part.mean_;
    return part.misfit_ + off.dot(part.information_ * off);
  };
  whole.misfit_ = std::max(misfit_at(*this) + misfit_at(other) - whole.mean_.dot(prior_information * whole.mean_), 0.0);
  whole.count_ = count_ + other.count_;
  return whole;
}

double BayesianRegression::freedom() const { return prior_.noise_examples + static_cast<double>(count_); }

RegressionPrediction BayesianRegression::predict(const Eigen::Ref<const Eigen::VectorXd>& features) const {
  if (features.size() != evidence_.size()) {
    throw std::invalid_argument("a prediction needs " + std::to_string(evidence_.size()) + " features, not " +
                                std::to_string(features.size()));
  }
  const double spread = features.dot(factor_.solve(features));
  const double known = prior_.noise_std * prior_.noise_std;
  const double variance =  // b / a
      std::isinf(prior_.noise_examples) ? known : (prior_.noise_examples * known + misfit_) / freedom();
  return {.mean = features.dot(mean_), .scale = std::sqrt(variance * (1.0 + spread)), .freedom = freedom()};
}

double BayesianRegression::noise_variance() const {
  const double known = prior_.noise_std * prior_.noise_std;
  if (std::isinf(prior_.noise_examples)) {
    return known;
  }
  const double freedom_left = freedom() - 2.0;
  return freedom_left > 0.0 ? (prior_.noise_examples * known + misfit_) / freedom_left
                            : std::numeric_limits<double>::infinity();
}

Eigen::MatrixXd BayesianRegression::covariance() const {
  return noise_variance() * factor_.solve(Eigen::MatrixXd::Identity(evidence_.size(), evidence_.size()));
}

Eigen::MatrixXd BayesianRegression::information() const { return information_ / noise_variance(); }

SlidingRegression::SlidingRegression(const RegressionPrior& prior, std::size_t window)
    : window_(window), regression_(prior) {
  if (window == 0) {
    throw std::invalid_argument("a sliding window needs at least one example");
  }
}

void SlidingRegression::add(const RegressionExample& example) {
  regression_.add(example);
  examples_.push_back(example);
  if (examples_.size() <= window_) {
    return;
  }
  const RegressionExample oldest = std::move(examples_.front());
  examples_.pop_front();
  if (++removed_ < window_) {
    regression_.remove(oldest);
    return;
  }
  removed_ = 0;
  regression_ = BayesianRegression(regression_.prior());
  for (const RegressionExample& kept : examples_) {
    regression_.add(kept);
  }
}

}  // namespace slipwise
