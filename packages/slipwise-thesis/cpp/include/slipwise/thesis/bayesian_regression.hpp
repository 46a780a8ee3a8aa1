// SPDX-License-Identifier: Apache-2.0
// Bayesian linear regression in information form, with known or learned noise.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <limits>

namespace slipwise {

/// The posterior before any example: weights are independent with mean zero.
struct RegressionPrior {
  Eigen::VectorXd weight_std;  ///< [d], each in the unit of the output over that of its feature
  double noise_std = 1.0;      ///< of one example, in the unit of the output
  /// How many examples the reported noise is worth; infinite: it is known (thesis 5.11), else learned with the weights.
  double noise_examples = std::numeric_limits<double>::infinity();
};

struct RegressionExample {
  Eigen::VectorXd features;   ///< [d]
  double output = 0.0;        ///< what was measured
  double relative_std = 1.0;  ///< its noise in units of the noise of an ordinary example [-]
};

/// Student-t distribution of the output of an ordinary example; Gaussian where `freedom` is infinite.
struct RegressionPrediction {
  double mean;
  double scale;    ///< not the standard deviation, see std()
  double freedom;  ///< degrees of freedom

  /// Standard deviation; infinite up to two degrees of freedom.
  double std() const;
};

/// y = x . theta + noise. Conjugate: theta | s^2 ~ N(m, s^2 L^-1), s^2 ~ inverse gamma.
class BayesianRegression {
 public:
  /// \throws std::invalid_argument when a prior standard deviation or the noise is not positive.
  explicit BayesianRegression(RegressionPrior prior);

  /// L += x x^T / r^2, h += x y / r^2 (thesis 5.13, 5.14, corrected); O(d^2). \throws std::invalid_argument.
  void add(const RegressionExample& example);
  /// The inverse of add; O(d^3). \throws std::invalid_argument when the example cannot have been added; nothing
  /// changes.
  void remove(const RegressionExample& example);
  /// What both would know together. \throws std::invalid_argument when their priors differ.
  BayesianRegression merged(const BayesianRegression& other) const;

  RegressionPrediction predict(const Eigen::Ref<const Eigen::VectorXd>& features) const;
  const Eigen::VectorXd& mean() const { return mean_; }
  Eigen::MatrixXd covariance() const;   ///< of the weights (thesis 5.16), times the noise's variance
  Eigen::MatrixXd information() const;  ///< inverse of covariance()
  double noise_variance() const;        ///< known, or the mean of its posterior
  double freedom() const;               ///< degrees of freedom of a prediction
  std::size_t examples() const { return count_; }
  const RegressionPrior& prior() const { return prior_; }

 private:
  void check(const RegressionExample& example) const;
  void refresh_mean() { mean_ = factor_.solve(evidence_); }

  RegressionPrior prior_;
  Eigen::MatrixXd information_;         // L, in units of 1 / noise variance, the prior's part included
  Eigen::VectorXd evidence_;            // h, in the same units
  Eigen::LLT<Eigen::MatrixXd> factor_;  // of L
  Eigen::VectorXd mean_;
  double misfit_ = 0.0;  // sum of squared one-step errors over their relative variances: 2 (b - b0)
  std::size_t count_ = 0;
};

/// A regression on the latest examples alone; made again from them now and then, so that rounding does not add up.
class SlidingRegression {
 public:
  /// \throws std::invalid_argument when the window is empty.
  SlidingRegression(const RegressionPrior& prior, std::size_t window);

  /// Adds one and removes the oldest where the window is full.
  void add(const RegressionExample& example);
  const BayesianRegression& regression() const { return regression_; }

 private:
  std::size_t window_;
  std::size_t removed_ = 0;  // since the regression was made again
  std::deque<RegressionExample> examples_;
  BayesianRegression regression_;
};

}  // namespace slipwise
