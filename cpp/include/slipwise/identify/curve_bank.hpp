// SPDX-License-Identifier: Apache-2.0
// A curve with its lag, learned recursively, and copies of it that compete from run to run (derivations/sensors.md).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slipwise/filter/hypothesis_bank.hpp"

namespace slipwise {

/// An error's square; large ones count less.
double huber_square(double error);

/// Least squares of increments that are not negative, for several lags side by side; the lag that predicts best counts.
class CurveBank {
 public:
  CurveBank() = default;
  /// `prior` and its `std` [d] of the weights; each output is known to about `noise`. Weights before `free` may be
  /// negative.
  CurveBank(std::size_t candidates, const Eigen::VectorXd& prior, const Eigen::VectorXd& std, double noise,
            Eigen::Index free);

  /// Scores each candidate by what it knew before, then learns; row k of `features` is that of candidate k.
  void learn(const Eigen::MatrixXd& features, double output);
  /// Solves for the weights that are used from now on; seldom for those of candidates that predict far worse.
  void solve();
  std::size_t best() const;
  /// Examples that it learned.
  double examples() const { return examples_; }
  /// Variance of what the best candidate predicted.
  double variance() const { return variance(best()); }
  /// What the best candidate misses of an output.
  double error(const Eigen::MatrixXd& features, double output) const;
  const Eigen::VectorXd& weights() const { return weights(best()); }
  /// Of a candidate.
  const Eigen::VectorXd& weights(std::size_t k) const { return weights_[k]; }
  /// Of its weights, as if none were bounded: rather too large.
  Eigen::MatrixXd covariance(std::size_t k) const;
  /// The same before anything was learned.
  Eigen::MatrixXd prior_covariance() const { return precision_.cwiseInverse().asDiagonal(); }
  /// Of each candidate, by the errors of what was predicted.
  Eigen::VectorXd log_likelihoods() const;

  /// \throws std::invalid_argument where a loaded one is none that `made` could have become.
  void check_loaded(const CurveBank& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.information_, self.evidence_, self.weights_, self.squares_, self.precision_, self.prior_, self.free_);
    a(self.examples_, self.noise_, self.solved_);
  }

 private:
  double variance(std::size_t k) const;

  std::vector<Eigen::MatrixXd> information_;  ///< of the data alone, in units of 1 / noise variance
  std::vector<Eigen::VectorXd> evidence_;
  std::vector<Eigen::VectorXd> weights_;
  std::vector<double> squares_;  ///< of the errors of what was predicted, large ones counted less
  Eigen::VectorXd precision_, prior_;
  Eigen::Index free_ = 0;
  double examples_ = 0.0, noise_ = 1.0;
  std::size_t solved_ = 0;  ///< times
};

/// A curve that may be another one from a run on, with another battery, floor or car: copies that go on from earlier
/// runs beside one that began in this run from the prior, weighted by how well they predict. The heaviest counts.
class CurveCopies {
 public:
  CurveCopies() = default;
  explicit CurveCopies(const CurveBank& prior);

  /// Another run begins.
  void start_run();
  void learn(const Eigen::MatrixXd& features, double output);
  void solve();
  const CurveBank& heaviest() const { return copies_[copies_.heaviest()]; }
  /// From the one that goes on from all runs to the one that began last.
  const HypothesisBank<CurveBank>& copies() const { return copies_; }

  /// \throws std::invalid_argument where a loaded one is none that `made` could have become.
  void check_loaded(const CurveCopies& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.prior_, self.copies_);
  }

 private:
  CurveBank prior_;
  HypothesisBank<CurveBank> copies_;
};

}  // namespace slipwise
