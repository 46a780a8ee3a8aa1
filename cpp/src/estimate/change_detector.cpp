// SPDX-License-Identifier: Apache-2.0
// A Bayesian form of the generalised likelihood ratio of Willsky and Jones (1976), with heavy tails.
#include "slipwise/estimate/change_detector.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "slipwise/estimate/heavy_tails.hpp"

namespace slipwise {
namespace {

constexpr int kIterations = 4;           // of iteratively reweighted least squares; more change nothing that matters
constexpr double kStart = 1e-3;          // weight of the change's prior in the first iteration, which has to get far
constexpr double kLargestRatio = 6.0;    // a gain counts at most this many times what is usual
constexpr double kUsualSegments = 20.0;  // whiteness is believed as if it had been seen over this many segments

/// The change that explains most, with the weights of the segments' residuals and of the change's prior there.
struct Fitted {
  Eigen::VectorXd change;
  Eigen::VectorXd row_weight;
  Eigen::VectorXd prior_weight;
};

Eigen::VectorXd squares_by_segment(const Eigen::VectorXd& residuals) {
  return Eigen::Map<const Eigen::Matrix3Xd>(residuals.data(), 3, residuals.size() / 3).colwise().squaredNorm();
}

Eigen::MatrixXd normal_matrix(const Eigen::MatrixXd& by_change, const Fitted& at) {
  Eigen::MatrixXd normal = by_change.transpose() * at.row_weight.asDiagonal() * by_change;
  normal.diagonal() += at.prior_weight;
  return normal;
}

void reweigh(Fitted& at, const Eigen::VectorXd& left) {
  const Eigen::VectorXd squares = squares_by_segment(left);
  for (Eigen::Index i = 0; i < at.row_weight.size(); ++i) {
    at.row_weight[i] = (kTailDegrees + 3.0) / (kTailDegrees + squares[i / 3]);
  }
  at.prior_weight = (1.0 + at.change.array().square() / 2.0).inverse();
}

/// Starts from least squares: from no change, residuals that agree with each other would all look like outliers.
Fitted fit(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& by_change) {
  const Eigen::Index changes = by_change.cols();
  Fitted at{Eigen::VectorXd::Zero(changes), Eigen::VectorXd::Ones(residuals.size()),
            Eigen::VectorXd::Constant(changes, kStart)};
  for (int i = 0; i < kIterations; ++i) {
    at.change = normal_matrix(by_change, at).llt().solve(by_change.transpose() * at.row_weight.cwiseProduct(residuals));
    reweigh(at, residuals - by_change * at.change);
  }
  return at;
}

}  // namespace

ChangeFit fit_change(const Eigen::VectorXd& residuals, const Eigen::MatrixXd& by_change) {
  const Fitted at = fit(residuals, by_change);
  const Eigen::ArrayXd before = squares_by_segment(residuals);
  const Eigen::ArrayXd after = squares_by_segment(residuals - by_change * at.change);
  const double explained = 0.5 * (kTailDegrees + 3.0) * ((kTailDegrees + before) / (kTailDegrees + after)).log().sum();
  const Eigen::LLT<Eigen::MatrixXd> normal(normal_matrix(by_change, at));
  const Eigen::MatrixXd spread = normal.solve(Eigen::MatrixXd::Identity(at.change.size(), at.change.size()));
  const double gain = explained - (at.change.array().square() / 2.0).log1p().sum();
  const double occam = normal.matrixLLT().diagonal().array().log().sum();  // half the log determinant
  const double determined = (1.0 - spread.diagonal().array() * at.prior_weight.array()).sum();
  return {.log_odds = gain - occam, .gain = gain, .expected_gain = 0.5 * determined};
}

ChangeDetector::ChangeDetector(const ChangeSettings& settings) : settings_(settings) {
  if (settings.shortest < 1 || settings.longest < settings.shortest) {
    throw std::invalid_argument("a change is tested over at least one segment, and `longest` is not below `shortest`");
  }
  usual_.assign(static_cast<std::size_t>(settings.longest) + 1, 1.0);
}

ChangeTest ChangeDetector::see(const Eigen::Vector3d& innovation, const Eigen::Matrix3d& covariance,
                               const Eigen::Matrix<double, 3, Eigen::Dynamic>& by_change) {
  if (!settings_.detect || by_change.cols() == 0) {
    return {};
  }
  seen_ += 1.0;
  // S^-1/2 by eigenvectors: any root serves, and the residuals' order within a segment does not matter.
  const Eigen::Matrix3d whiten = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).operatorInverseSqrt();
  recent_.push_back({whiten * innovation, whiten.lazyProduct(by_change)});
  if (std::ssize(recent_) > settings_.longest) {
    recent_.pop_front();
  }
  ChangeTest best;
  for (int n = settings_.shortest; n <= static_cast<int>(std::ssize(recent_)); ++n) {
    const ChangeFit found = fit_last(n, usual_[static_cast<std::size_t>(n)]);
    if (found.log_odds > best.log_odds) {
      best = {.log_odds = found.log_odds, .segments = n, .alarm = false};
    }
    learn_usual(n, found);
  }
  best.alarm = best.log_odds > settings_.threshold && seen_ > settings_.warm_up;
  if (best.alarm) {
    recent_.clear();
  }
  return best;
}

/// The last segments, as if their residuals were `usual` times as large in square.
ChangeFit ChangeDetector::fit_last(int segments, double usual) const {
  const double unit = 1.0 / std::sqrt(std::max(usual, 1.0));
  const Eigen::Index rows = Eigen::Index{3} * segments;
  const Eigen::Index changes = recent_.back().by_change.cols();
  Eigen::VectorXd residuals(rows);
  Eigen::MatrixXd by_change(rows, changes);
  for (int i = 0; i < segments; ++i) {
    const Eigen::Index row = Eigen::Index{3} * i;
    const Whitened& segment = recent_[recent_.size() - static_cast<std::size_t>(segments - i)];
    residuals.segment<3>(row) = unit * segment.residual;
    by_change.middleRows<3>(row) = unit * segment.by_change;
  }
  return fit_change(residuals, by_change);
}

void ChangeDetector::learn_usual(int segments, const ChangeFit& fit) {
  if (fit.expected_gain <= 0.0) {
    return;  // nothing could have been seen, as on a parked robot
  }
  double& usual = usual_[static_cast<std::size_t>(segments)];
  const double ratio = std::clamp(fit.gain / fit.expected_gain, 0.0, kLargestRatio) * std::max(usual, 1.0);
  usual += std::max(1.0 / (seen_ + kUsualSegments), 1.0 / settings_.memory) * (ratio - usual);
}

}  // namespace slipwise
