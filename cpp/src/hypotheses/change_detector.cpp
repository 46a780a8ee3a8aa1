// SPDX-License-Identifier: Apache-2.0
// The odds of Shiryaev (1963) and Roberts (1966) for the additive changes of Willsky and Jones (1976), with heavy
// tails.
#include "slipwise/hypotheses/change_detector.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kChangeTailDegrees, 12.0);    // of the Student-t that weighs residuals
SLIPWISE_TUNING(kSizeSegments, 5.0);          // the size counts as if it had been predicted over this many segments
SLIPWISE_TUNING(kCorrelationSegments, 20.0);  // and neighbours as if they had been unlike over this many
SLIPWISE_TUNING(kLargestSquare, 9.0);         // a squared residual counts at most this many times its size
SLIPWISE_TUNING(kLeastSize, 0.1);             // smaller residuals count as of this square size
SLIPWISE_TUNING(kMostAlike, 0.95);            // the largest correlation of neighbours
SLIPWISE_TUNING(kParked, 0.01);  // a segment that could tell less than this is not held against its neighbour

}  // namespace

ChangeDetector::ChangeDetector(const ChangeSettings& settings, ChangeKinds kinds)
    : settings_(settings), kinds_(std::move(kinds)) {
  if (settings.shortest < 1 || settings.longest < settings.shortest) {
    throw std::invalid_argument("a change is tested over at least one segment, and `longest` is not below `shortest`");
  }
  if (std::ranges::any_of(kinds_, &std::vector<Eigen::Index>::empty)) {
    throw std::invalid_argument("each kind of change needs at least one column");
  }
  known_.emplace_back().squares.setConstant(kCorrelationSegments);
}

ChangeTest ChangeDetector::see(const Eigen::Vector3d& innovation, const Eigen::Matrix3d& covariance,
                               const Eigen::Matrix<double, 3, Eigen::Dynamic>& by_change) {
  if (!settings_.detect || kinds_.empty()) {
    return {};
  }
  observed_ += 1.0;
  const Whitened segment = whitened(innovation, covariance, by_change);
  const Whitened fresh = apart_from_last(segment);
  const double weight = std::min((kChangeTailDegrees + 3.0) / (kChangeTailDegrees + fresh.residual.squaredNorm()), 1.0);
  recent_.push_back({.information = weight * fresh.by_change.transpose() * fresh.by_change,
                     .score = weight * fresh.by_change.transpose() * fresh.residual});
  if (std::ssize(recent_) > settings_.longest) {
    recent_.pop_front();
  }
  learn_likeness(segment);
  last_ = segment;
  ChangeTest found = test();
  const bool warm = observed_ > settings_.warm_up;
  found.alarm = warm && found.log_odds > settings_.threshold;
  found.suspicion = warm && found.log_odds > std::min(settings_.suspicion, settings_.threshold);
  if (found.alarm) {
    restart();
  }
  return found;
}

/// By S^-1/2 of eigenvectors: the one root that is symmetric keeps the directions (x, y, theta) apart.
ChangeDetector::Whitened ChangeDetector::whitened(const Eigen::Vector3d& innovation, const Eigen::Matrix3d& covariance,
                                                  const Eigen::Matrix<double, 3, Eigen::Dynamic>& by_change) const {
  const Eigen::Matrix3d root = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).operatorInverseSqrt();
  Whitened segment{.residual = root * innovation, .by_change = root.lazyProduct(by_change), .telling = 0.0};
  segment.telling = 1.0 - 1.0 / (1.0 + segment.by_change.squaredNorm());
  return segment;
}

/// In units of how large residuals were up to `longest` segments ago, since a covariance that is still wide from the
/// first segments would hide a change, and less what the segment before lets expect of it. Both as they were known
/// before a change that is tested, which would teach them to expect it.
ChangeDetector::Whitened ChangeDetector::apart_from_last(const Whitened& segment) const {
  const Likeness& known = known_.front();
  Whitened fresh = segment;
  Eigen::Vector3d unit = known.size.cwiseMax(kLeastSize).cwiseMin(1.0).cwiseSqrt().cwiseInverse();
  if (last_ && std::min(last_->telling, segment.telling) > kParked) {
    const Eigen::Vector3d correlation = known.correlation();
    fresh.residual -= correlation.cwiseProduct(last_->residual);
    fresh.by_change -= correlation.asDiagonal() * last_->by_change;
    unit.array() /= (1.0 - correlation.array().square()).sqrt();
  }
  fresh.residual = unit.cwiseProduct(fresh.residual);
  fresh.by_change = unit.asDiagonal() * fresh.by_change;
  return fresh;
}

/// A segment teaches as much as it could tell of a change: poses of a parked robot hardly err, and say nothing of those
/// of a moving one.
void ChangeDetector::learn_likeness(const Whitened& segment) {
  Likeness known = known_.back();
  const Eigen::Vector3d most = (kLargestSquare * known.size).cwiseSqrt();
  const Eigen::Vector3d bounded = segment.residual.cwiseMin(most).cwiseMax(-most);
  sized_ += segment.telling;
  const double gain = segment.telling * std::max(1.0 / (sized_ + kSizeSegments), 1.0 / settings_.forgetting_time);
  if (last_) {
    const double taught = std::min(segment.telling, last_->telling);
    const double keep = 1.0 - taught / settings_.forgetting_time;
    const Eigen::Vector3d before = last_->residual.cwiseMin(most).cwiseMax(-most);
    known.products = keep * known.products + taught * bounded.cwiseProduct(before).cwiseQuotient(known.size);
    known.squares = keep * known.squares + taught * before.cwiseAbs2().cwiseQuotient(known.size);
  }
  known.size += gain * (bounded.cwiseAbs2() - known.size);
  known_.push_back(known);
  if (std::ssize(known_) > settings_.longest) {
    known_.pop_front();
  }
}

Eigen::Vector3d ChangeDetector::Likeness::correlation() const {
  return products.cwiseQuotient(squares).cwiseMax(0.0).cwiseMin(kMostAlike);
}

/// A change is as likely at any of the last `longest` segments. Sums over 1, 2, 3, 4, 6, 8, 12, ... segments stand for
/// the starts between them, since neighbouring starts share most of what speaks for them.
ChangeTest ChangeDetector::test() const {
  const Eigen::Index changes = recent_.back().score.size();
  Evidence sum{.information = Eigen::MatrixXd::Zero(changes, changes), .score = Eigen::VectorXd::Zero(changes)};
  ChangeTest found{.log_odds = -std::numeric_limits<double>::infinity(), .segments = 0};
  double most = found.log_odds;
  int next = settings_.shortest;
  int counted = 0;
  for (int n = 1; n <= static_cast<int>(std::ssize(recent_)); ++n) {
    const Evidence& one = recent_[recent_.size() - static_cast<std::size_t>(n)];
    sum.information += one.information;
    sum.score += one.score;
    if (n < next) {
      continue;
    }
    const double odds = log_odds(sum) + std::log(static_cast<double>(n - counted) / settings_.longest);
    const double larger = std::max(found.log_odds, odds);
    found.log_odds = larger + std::log1p(std::exp(std::min(found.log_odds, odds) - larger));
    if (odds > most) {
      most = odds;
      found.segments = n;
    }
    counted = n;
    next = std::min(n + std::max(static_cast<int>(std::bit_floor(static_cast<unsigned>(n))) / 2, 1),
                    std::max(settings_.longest, n + 1));
  }
  return found.segments > 0 ? found : ChangeTest{};
}

/// Log of the mean odds of the kinds of change, in each of which d ~ N(0, 1). A kind with few changes pays for little
/// freedom, and sees a change that is of its kind sooner than one with many; the mean costs at most the logarithm of
/// their number.
double ChangeDetector::log_odds(const Evidence& sum) const {
  Eigen::ArrayXd each(std::ssize(kinds_));
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    Eigen::MatrixXd normal = sum.information(kinds_[k], kinds_[k]);
    normal.diagonal().array() += 1.0;
    const Eigen::VectorXd score = sum.score(kinds_[k]);
    const Cholesky factor(normal);
    each[static_cast<Eigen::Index>(k)] = (score.dot(factor.solve(score)) - factor.log_determinant()) / 2.0;
  }
  const double most = each.maxCoeff();
  return most + std::log((each - most).exp().mean());
}

}  // namespace slipwise
