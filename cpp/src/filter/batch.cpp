// SPDX-License-Identifier: Apache-2.0
// Normal equations of the robust MAP cost of all segments.
#include "slipwise/filter/batch.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/segment/carried_linearization.hpp"

namespace slipwise {
namespace {

struct HuberLoss {
  double cost;
  double weight;
};

/// Cost of a squared Mahalanobis distance and the weight of its re-weighted least squares.
HuberLoss huber_loss(double squared, double threshold) {
  const double distance = std::sqrt(squared);
  if (distance <= threshold) {
    return {squared, 1.0};
  }
  return {2.0 * threshold * distance - threshold * threshold, threshold / distance};
}

std::vector<NewError> new_errors(std::span<const BatchDatum> data) {
  std::vector<NewError> errors;
  errors.reserve(data.size());
  for (const BatchDatum& datum : data) {
    RowsCovariance by_before;
    RowsCovariance noise = datum.noise;
    if (!errors.empty() && datum.shared.size() > 0) {
      by_before = errors.back().noise.solve(datum.shared.transpose()).transpose();
      noise -= by_before * datum.shared.transpose();
    }
    errors.push_back({std::move(by_before), noise.llt()});
  }
  return errors;
}

void check(const MotionModel& model, const Estimate& prior, std::span<const BatchDatum> data,
           const Eigen::VectorXd& start) {
  model.check(prior.mean);
  if (start.size() > 0) {
    model.check(start);
  }
  if (prior.covariance.rows() != model.size() || prior.covariance.cols() != model.size()) {
    throw std::invalid_argument("the prior's covariance must be square with one row per parameter, " +
                                std::to_string(model.size()) + "; got " + std::to_string(prior.covariance.rows()) +
                                " x " + std::to_string(prior.covariance.cols()));
  }
  if (!Cholesky(prior.covariance).positive_definite()) {
    throw std::invalid_argument("the prior's covariance must be positive definite; give every parameter some spread");
  }
  if (data.empty()) {
    throw std::invalid_argument("a batch fit needs at least one segment");
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Segment& segment = data[i].segment;
    if (!(segment.end > segment.start) || !rows_of(segment.measured).allFinite() ||
        data[i].noise.rows() != rows_of(segment.measured).size() || !Cholesky(data[i].noise).positive_definite()) {
      throw std::invalid_argument("segment " + std::to_string(i) +
                                  " must end after it starts, and have finite measurements and a positive "
                                  "definite noise covariance");
    }
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    const RowsCovariance& shared = data[i].shared;
    const bool fits = i > 0 && shared.rows() == data[i].noise.rows() && shared.cols() == data[i - 1].noise.rows();
    if (shared.size() > 0 && i > 0 && !fits) {
      throw std::invalid_argument("segment " + std::to_string(i) +
                                  " shares noise of other rows than it and the one before have");
    }
  }
  const std::vector<NewError> errors = new_errors(data);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const RowsCovariance& shared = data[i].shared;
    if (!shared.allFinite() || errors[i].noise.info() != Eigen::Success) {
      throw std::invalid_argument("segment " + std::to_string(i) +
                                  " shares more noise with the one before than both have: their covariance must be "
                                  "finite and positive definite");
    }
  }
}

}  // namespace

BatchSearch::BatchSearch(MotionModel model, Estimate prior, std::vector<BatchDatum> data, const BatchSettings& settings,
                         std::vector<SegmentLinearization> at_start)
    : model_(std::move(model)),
      prior_(std::move(prior)),
      data_(std::move(data)),
      huber_(settings.huber),
      carry_(settings.carry),
      search_(settings.start.size() > 0 ? settings.start : prior_.mean,
              {.iterations = settings.iterations, .relative = settings.tolerance}) {
  check_data();
  if (!at_start.empty() && at_start.size() != data_.size()) {
    throw std::invalid_argument("of all data or of none the linearisation at the start must be given");
  }
  prior_information_ = Cholesky(prior_.covariance).inverse();
  if (!at_start.empty()) {
    judge(point(std::move(at_start)));
  }
}

void BatchSearch::check_data() {
  check(model_, prior_, data_, search_.candidate());
  errors_ = new_errors(data_);
}

/// The candidate, where the data are linearised `at`.
BatchPoint BatchSearch::point(std::vector<SegmentLinearization> data_at) const {
  const Eigen::VectorXd back = prior_.mean - search_.candidate();
  BatchPoint point{
      {prior_information_, prior_information_ * back}, back.dot(prior_information_ * back), std::move(data_at)};
  Rows r;
  RowsJacobian by_parameter;
  for (std::size_t i = 0; i < data_.size(); ++i) {
    const SegmentLinearization& at = point.at[i];
    const RowsCovariance& by_before = errors_[i].by_before;
    const bool shared = by_before.size() > 0;
    r = shared ? Rows(error_of(data_[i].segment, at) - by_before * r) : error_of(data_[i].segment, at);
    by_parameter = shared ? RowsJacobian(at.by_parameter - by_before * by_parameter) : at.by_parameter;
    const Eigen::LLT<RowsCovariance>& noise = errors_[i].noise;
    const HuberLoss loss = huber_loss(r.dot(noise.solve(r)), huber_);
    const RowsJacobian weighted = noise.solve(by_parameter) * loss.weight;
    point.cost += loss.cost;
    point.equations.information.noalias() += by_parameter.transpose() * weighted;
    point.equations.gradient.noalias() += weighted.transpose() * r;
  }
  return point;
}

void BatchSearch::judge(BatchPoint point) {
  if (search_.judge(point.cost)) {
    best_ = std::move(point);
  }
  search_.propose(present(best_).equations);
}

SegmentLinearization BatchSearch::linearised(std::size_t datum) const {
  if (carry_ && best_) {
    if (auto straight = carried(best_->at[datum], model_, search_.candidate() - search_.best(), data_[datum].noise)) {
      return std::move(*straight);
    }
  }
  return linearize_segment(model_, search_.candidate(), data_[datum].inputs, data_[datum].segment);
}

bool BatchSearch::advance(std::size_t segments) {
  for (std::size_t i = 0; i < segments && !search_.over(); ++i) {
    at_.push_back(linearised(at_.size()));
    if (at_.size() == data_.size()) {
      judge(point(std::exchange(at_, {})));
    }
  }
  return !search_.over();
}

BatchFit BatchSearch::result() && {
  BatchPoint& best = present(best_);
  return {.estimate = {search_.best(), Cholesky(best.equations.information).inverse()},
          .cost = best.cost,
          .iterations = search_.iterations(),
          .status = search_.converged() ? Status::Converged : Status::NotConverged,
          .at = std::move(best.at)};
}

BatchFit batch_fit(const MotionModel& model, const Estimate& prior, std::vector<BatchDatum> data,
                   const BatchSettings& settings, std::vector<SegmentLinearization> at_start) {
  const std::size_t all = data.size();
  BatchSearch search(model, prior, std::move(data), settings, std::move(at_start));
  while (search.advance(all)) {
  }
  return std::move(search).result();
}

}  // namespace slipwise
