// SPDX-License-Identifier: Apache-2.0
// A Bayesian form of the generalised likelihood ratio of Willsky and Jones (1976), with heavy tails.
#include "slipwise/hypotheses/change_detector.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <ranges>
#include <stdexcept>
#include <utility>

#include "slipwise/filter/heavy_tails.hpp"
#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

constexpr int kIterations = 4;            // of iteratively reweighted least squares; more change nothing that matters
constexpr double kStart = 1e-3;           // weight of the change's prior in the first iteration, which has to get far
SLIPWISE_TUNING(kLargestRatio, 6.0);      // a gain counts at most this many times what is nominal
SLIPWISE_TUNING(kNominalSegments, 20.0);  // whiteness counts as if it had been observed over this many segments
SLIPWISE_TUNING(kSizeSegments, 5.0);      // and the size that was predicted over this many
SLIPWISE_TUNING(kLargestSquare, 9.0);     // a squared residual counts at most this many times its size
SLIPWISE_TUNING(kLeastSize, 0.1);         // smaller residuals count as of this square size

/// The change that explains most, with the weights of the segments' residuals and of the change's prior there.
struct Fitted {
  Eigen::VectorXd change;
  Eigen::VectorXd row_weight;
  Eigen::VectorXd prior_weight;
};

Eigen::VectorXd squares_by_segment(const Eigen::VectorXd& residuals, Eigen::Index rows) {
  return residuals.reshaped(rows, residuals.size() / rows).colwise().squaredNorm();
}

Eigen::MatrixXd normal_matrix(const Eigen::MatrixXd& by_change, const Fitted& at) {
  Eigen::MatrixXd normal = by_change.transpose() * at.row_weight.asDiagonal() * by_change;
  normal.diagonal() += at.prior_weight;
  return normal;
}

void reweigh(Fitted& at, const Eigen::VectorXd& left, Eigen::Index rows) {
  const Eigen::VectorXd squares = squares_by_segment(left, rows);
  for (Eigen::Index i = 0; i < at.row_weight.size(); ++i) {
    at.row_weight[i] = (kTailDegrees + 3.0) / (kTailDegrees + squares[i / rows]);
  }
  at.prior_weight = (1.0 + at.change.array().square() / 2.0).inverse();
}

/// Starts from least squares: from no change, residuals that agree with each other would all look like outliers.
Fitted fit(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& by_change, Eigen::Index rows) {
  const Eigen::Index changes = by_change.cols();
  Fitted at{Eigen::VectorXd::Zero(changes), Eigen::VectorXd::Ones(residuals.size()),
            Eigen::VectorXd::Constant(changes, kStart)};
  for (int i = 0; i < kIterations; ++i) {
    at.change =
        Cholesky(normal_matrix(by_change, at)).solve(by_change.transpose() * at.row_weight.cwiseProduct(residuals));
    reweigh(at, residuals - by_change * at.change, rows);
  }
  return at;
}

}  // namespace

ChangeFit fit_change(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& by_change, Eigen::Index rows) {
  const Fitted at = fit(residuals, by_change, rows);
  const Eigen::ArrayXd before = squares_by_segment(residuals, rows);
  const Eigen::ArrayXd after = squares_by_segment(residuals - by_change * at.change, rows);
  const double explained = 0.5 * (kTailDegrees + 3.0) * ((kTailDegrees + before) / (kTailDegrees + after)).log().sum();
  const Cholesky normal(normal_matrix(by_change, at));
  const Eigen::MatrixXd spread = normal.inverse();
  const double gain = explained - (at.change.array().square() / 2.0).log1p().sum();
  const double occam = normal.log_determinant() / 2.0;
  const double determined = (1.0 - spread.diagonal().array() * at.prior_weight.array()).sum();
  return {.log_odds = gain - occam, .gain = gain, .expected_gain = 0.5 * determined};
}

ChangeDetector::ChangeDetector(const ChangeSettings& settings, ChangeKinds kinds)
    : settings_(settings), kinds_(std::move(kinds)) {
  if (settings.shortest < 1 || settings.longest < settings.shortest) {
    throw std::invalid_argument("a change is tested over at least one segment, and `longest` is not below `shortest`");
  }
  if (std::ranges::any_of(kinds_, &std::vector<Eigen::Index>::empty)) {
    throw std::invalid_argument("each kind of change needs at least one column");
  }
  sizes_.emplace_back(Eigen::Vector3d::Ones());
  nominal_ = Eigen::MatrixXd::Ones(settings.longest + 1, std::ssize(kinds_));
}

ChangeTest ChangeDetector::see(const Directions& directions, const Rows& innovation, const RowsCovariance& covariance,
                               const RowsJacobian& by_change) {
  if (!settings_.detect || kinds_.empty()) {
    return {};
  }
  observed_ += 1.0;
  recent_.push_back(whitened(directions, innovation, covariance, by_change));
  if (std::ssize(recent_) > settings_.longest) {
    recent_.pop_front();
  }
  ChangeTest best;
  for (int n = settings_.shortest; n <= static_cast<int>(std::ssize(recent_)); ++n) {
    const double log_odds = test_last(n);
    if (log_odds > best.log_odds) {
      best = {.log_odds = log_odds, .segments = n};
    }
  }
  const bool warm = observed_ > settings_.warm_up;
  best.alarm = warm && best.log_odds > settings_.threshold;
  best.suspicion = warm && best.log_odds > std::min(settings_.suspicion, settings_.threshold);
  if (best.alarm) {
    restart();
  }
  return best;
}

/// By the covariance, and by how large residuals were up to `longest` segments ago: a covariance that is still wide
/// from the first segments would hide a change. A segment teaches the size as much as it could tell of a change: poses
/// of a parked robot hardly err, and say nothing of those of a moving one.
ChangeDetector::Whitened ChangeDetector::whitened(const Directions& directions, const Rows& innovation,
                                                  const RowsCovariance& covariance, const RowsJacobian& by_change) {
  // S^-1/2 by eigenvectors: the one root that is symmetric keeps the directions (x, y, theta) apart.
  const RowsCovariance root = Eigen::SelfAdjointEigenSolver<RowsCovariance>(covariance).operatorInverseSqrt();
  const Rows residual = root * innovation;
  const RowsJacobian derivative = root.lazyProduct(by_change);
  const Eigen::Vector3d last = sizes_.back();
  const double commanded = 1.0 - 1.0 / (1.0 + derivative.squaredNorm());
  sized_ += commanded;
  const double gain = commanded * std::max(1.0 / (sized_ + kSizeSegments), 1.0 / settings_.forgetting_time);
  Eigen::Vector3d next = last;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const double size = last[directions[i]];
    next[directions[i]] += gain * (std::min(residual[i] * residual[i], kLargestSquare * size) - size);
  }
  sizes_.push_back(next);
  const Eigen::Vector3d units = sizes_.front().cwiseMax(kLeastSize).cwiseMin(1.0).cwiseSqrt().cwiseInverse();
  const Rows unit = units(directions);
  if (std::ssize(sizes_) > settings_.longest) {
    sizes_.pop_front();
  }
  return {unit.cwiseProduct(residual), unit.asDiagonal() * derivative};
}

/// Log of the mean odds of the kinds of change. A kind with few changes pays for little freedom, and sees a change that
/// is of its kind sooner than one with many; the mean costs at most the logarithm of their number.
double ChangeDetector::test_last(int segments) {
  Eigen::ArrayXd log_odds(std::ssize(kinds_));
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    double& nominal = nominal_(segments, column);
    const ChangeFit found = fit_last(segments, kinds_[k], nominal);
    log_odds[column] = found.log_odds;
    learn_nominal(nominal, found);
  }
  const double most = log_odds.maxCoeff();
  return most + std::log((log_odds - most).exp().mean());
}

/// The last segments, as if their residuals were `nominal` times as large in square.
ChangeFit ChangeDetector::fit_last(int segments, const std::vector<Eigen::Index>& kind, double nominal) const {
  const double unit = 1.0 / std::sqrt(std::max(nominal, 1.0));
  const auto last = recent_ | std::views::drop(std::ssize(recent_) - segments);
  Eigen::Index rows = 1;  // of a segment that has most; others are filled up with rows of nothing
  for (const Whitened& segment : last) {
    rows = std::max(rows, segment.residual.size());
  }
  Eigen::VectorXd residuals = Eigen::VectorXd::Zero(rows * segments);
  Eigen::MatrixXd by_change = Eigen::MatrixXd::Zero(rows * segments, std::ssize(kind));
  Eigen::Index row = 0;
  for (const Whitened& segment : last) {
    residuals.segment(row, segment.residual.size()) = unit * segment.residual;
    by_change.middleRows(row, segment.residual.size()) = unit * segment.by_change(Eigen::all, kind);
    row += rows;
  }
  return fit_change(residuals, by_change, rows);
}

void ChangeDetector::learn_nominal(double& nominal, const ChangeFit& fit) const {
  if (fit.expected_gain <= 0.0) {
    return;  // nothing could have been observed, as on a parked robot
  }
  const double ratio = std::clamp(fit.gain / fit.expected_gain, 0.0, kLargestRatio) * std::max(nominal, 1.0);
  nominal += std::max(1.0 / (observed_ + kNominalSegments), 1.0 / settings_.forgetting_time) * (ratio - nominal);
}

}  // namespace slipwise
