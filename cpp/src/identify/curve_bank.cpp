// SPDX-License-Identifier: Apache-2.0
// Lags side by side, each with recursive least squares of its own; copies of them side by side from run to run.
#include "slipwise/identify/curve_bank.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <vector>

#include "slipwise/filter/weighting.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/nonnegative.hpp"
#include "slipwise/linear/rows.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kAlike, 0.2);  // examples next to each other are alike: each counts as so many
SLIPWISE_TUNING(kNoiseExamples, 20.0);
SLIPWISE_TUNING(kChanged, 0.1);  // prior weight of a curve that begins again with a run, over that of one that goes on
constexpr double kFar = 20.0;    // of the logarithm of a likelihood, behind the best
constexpr std::size_t kSeldom = 8;  // solutions of the others, from one of such a candidate to the next
constexpr double kHuber = 2.0;      // standard deviations, beyond which errors count less
constexpr std::size_t kCopies = 3;  // at most

}  // namespace

double huber_square(double error) {
  const double size = std::abs(error);
  return size > kHuber ? 2.0 * kHuber * size - kHuber * kHuber : error * error;
}

CurveBank::CurveBank(std::size_t candidates, const Eigen::VectorXd& prior, const Eigen::VectorXd& std, double noise,
                     Eigen::Index free)
    : information_(candidates, Eigen::MatrixXd::Zero(prior.size(), prior.size())),
      evidence_(candidates, Eigen::VectorXd::Zero(prior.size())),
      weights_(candidates, prior),
      squares_(candidates, 0.0),
      precision_(std.cwiseAbs2().cwiseInverse()),
      prior_(prior),
      free_(free),
      noise_(noise) {}

double CurveBank::variance(std::size_t k) const {
  return (kNoiseExamples * noise_ * noise_ + squares_[k]) / (kNoiseExamples + examples_);
}

void CurveBank::learn(const Eigen::MatrixXd& features, double output) {
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    const Eigen::VectorXd row = features.row(static_cast<Eigen::Index>(k)).transpose();
    const double size = variance(k);
    const double error = (output - row.dot(weights_[k])) / std::sqrt(size);
    const double weight = kAlike / std::max(1.0, std::abs(error) / kHuber);
    squares_[k] += size * huber_square(error);
    information_[k].noalias() += (weight * row) * row.transpose();
    evidence_[k] += weight * output * row;
  }
  examples_ += 1.0;
}

void CurveBank::solve() {
  const Eigen::Index d = prior_.size();
  const Eigen::VectorXd likely = log_likelihoods();
  const double least = likely.maxCoeff() - kFar;
  const bool all = solved_++ % kSeldom == 0;
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    if (!all && likely[static_cast<Eigen::Index>(k)] < least) {
      continue;
    }
    // A weight that may be negative is the difference of two that may not.
    Eigen::MatrixXd a(d + free_, d + free_);
    Eigen::VectorXd b(d + free_);
    a.topLeftCorner(d, d) = information_[k] / variance(k);
    a.topLeftCorner(d, d).diagonal() += precision_;
    b.head(d) = evidence_[k] / variance(k) + precision_.cwiseProduct(prior_);
    a.bottomLeftCorner(free_, d) = -a.topLeftCorner(free_, d);
    a.topRightCorner(d, free_) = -a.topLeftCorner(d, free_);
    a.bottomRightCorner(free_, free_) = a.topLeftCorner(free_, free_);
    a.bottomRightCorner(free_, free_).diagonal() += 1e-6 * precision_.head(free_);
    b.tail(free_) = -b.head(free_);
    Eigen::VectorXd near(d + free_);
    near << weights_[k], -weights_[k].head(free_);
    const Eigen::VectorXd x = nonnegative_solution(a, b, near.cwiseMax(0.0));
    weights_[k] = x.head(d);
    weights_[k].head(free_) -= x.tail(free_);
  }
}

std::size_t CurveBank::best() const {
  return static_cast<std::size_t>(std::ranges::min_element(squares_) - squares_.begin());
}

double CurveBank::error(const Eigen::MatrixXd& features, double output) const {
  return output - features.row(static_cast<Eigen::Index>(best())).dot(weights());
}

Eigen::VectorXd CurveBank::log_likelihoods() const {
  Eigen::VectorXd logarithm(std::ssize(squares_));
  for (std::size_t k = 0; k < squares_.size(); ++k) {
    logarithm[static_cast<Eigen::Index>(k)] = -0.5 * kAlike * examples_ * std::log(variance(k));
  }
  return logarithm;
}

Eigen::MatrixXd CurveBank::covariance(std::size_t k) const {
  Eigen::MatrixXd information = information_[k] / variance(k);
  information.diagonal() += precision_;
  return Cholesky(information).inverse();
}

CurveCopies::CurveCopies(const CurveBank& prior) : prior_(prior) { copies_.add(prior, 1.0); }

void CurveCopies::start_run() {
  const std::vector<CurveBank>& keys = copies_.keys();
  if (!(keys.back().examples() > 0.0)) {
    return;
  }
  std::vector<std::size_t> kept(keys.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  if (kept.size() == kCopies) {
    const Eigen::VectorXd others = copies_.weights().tail(std::ssize(kept) - 1);  // the first goes on from all runs
    kept.erase(kept.begin() + 1 + (std::ranges::min_element(others) - others.begin()));
  }
  const HypothesisBank<CurveBank> before = copies_.chosen(kept);
  Eigen::VectorXd weights = before.weights();
  weights *= 1.0 / weights.sum();
  copies_ = {};
  for (std::size_t i = 0; i < before.size(); ++i) {
    copies_.add(before[i], weights[static_cast<Eigen::Index>(i)]);
  }
  copies_.join(prior_, kChanged, 0.0);
}

void CurveCopies::learn(const Eigen::MatrixXd& features, double output) {
  if (copies_.size() > 1) {
    std::vector<Rows> errors;
    std::vector<RowsCovariance> variances;
    for (const CurveBank& copy : copies_.keys()) {
      errors.emplace_back(Rows::Constant(1, copy.error(features, output)));
      variances.emplace_back(RowsCovariance::Constant(1, 1, copy.variance()));
    }
    copies_.learn(common_log_scores(copies_.weights(), errors, variances), {.learning_rate = kAlike});
  }
  for (CurveBank& copy : copies_.keys()) {
    copy.learn(features, output);
  }
}

void CurveCopies::solve() {
  for (CurveBank& copy : copies_.keys()) {
    copy.solve();
  }
}

}  // namespace slipwise
