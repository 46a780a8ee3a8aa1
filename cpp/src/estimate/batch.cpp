// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt on the robust MAP cost of all segments.
#include "slipwise/estimate/batch.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slipwise/linear/cholesky.hpp"
#include "slipwise/linear/present.hpp"

namespace slipwise {
namespace {

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Of the information's diagonal: what hardly slows the last steps, what shortens a step at all, and what leaves none.
constexpr double kLeastDamping = 1e-4, kFelt = 0.1, kMostDamping = 1e12;

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
    Eigen::Matrix3d by_before = Eigen::Matrix3d::Zero();
    if (!errors.empty()) {
      by_before = errors.back().noise.solve(datum.shared.transpose()).transpose();
    }
    errors.push_back({by_before, (datum.noise - by_before * datum.shared.transpose()).llt()});
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
    if (!(segment.end > segment.start) || !segment.measured.vector().allFinite() ||
        !Cholesky(data[i].noise).positive_definite()) {
      throw std::invalid_argument("segment " + std::to_string(i) +
                                  " must end after it starts, and have finite measurements and a positive "
                                  "definite noise covariance");
    }
  }
  const std::vector<NewError> errors = new_errors(data);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!data[i].shared.allFinite() || errors[i].noise.info() != Eigen::Success) {
      throw std::invalid_argument("segment " + std::to_string(i) +
                                  " shares more noise with the one before than both have: their covariance must be "
                                  "finite and positive definite");
    }
  }
}

}  // namespace

BatchSearch::BatchSearch(MotionModel model, Estimate prior, std::vector<BatchDatum> data, BatchSettings settings,
                         std::vector<SegmentLinearization> at_start)
    : model_(std::move(model)),
      prior_(std::move(prior)),
      data_(std::move(data)),
      settings_(std::move(settings)),
      damping_(kLeastDamping),
      fit_{prior_, 0.0, 0, Status::NotConverged, {}} {
  check_data();
  if (!at_start.empty() && at_start.size() != data_.size()) {
    throw std::invalid_argument("of all data or of none the linearisation at the start must be given");
  }
  prior_information_ = Cholesky(prior_.covariance).inverse();
  mean_ = candidate_ = settings_.start.size() > 0 ? settings_.start : prior_.mean;
  if (!at_start.empty()) {
    now_ = normal_equations(std::move(at_start));
    propose();
  }
}

void BatchSearch::check_data() {
  check(model_, prior_, data_, settings_.start);
  errors_ = new_errors(data_);
}

/// At the candidate.
NormalEquations BatchSearch::normal_equations(std::vector<SegmentLinearization> data_at) const {
  const Eigen::VectorXd back = prior_.mean - candidate_;
  NormalEquations equations{prior_information_, prior_information_ * back, back.dot(prior_information_ * back),
                            std::move(data_at)};
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  Jacobian by_parameter = Jacobian::Zero(3, model_.size());
  for (std::size_t i = 0; i < data_.size(); ++i) {
    const SegmentLinearization& at = equations.at[i];
    r = data_[i].segment.measured.vector() - at.predicted.vector() - errors_[i].by_before * r;
    by_parameter = at.by_parameter - errors_[i].by_before * by_parameter;
    const Eigen::LLT<Eigen::Matrix3d>& noise = errors_[i].noise;
    const HuberLoss loss = huber_loss(r.dot(noise.solve(r)), settings_.huber);
    const Jacobian weighted = noise.solve(by_parameter) * loss.weight;
    equations.cost += loss.cost;
    equations.information.noalias() += by_parameter.transpose() * weighted;
    equations.gradient.noalias() += weighted.transpose() * r;
  }
  return equations;
}

/// The next point to look at, where one is worth a look.
void BatchSearch::propose() {
  const NormalEquations& now = present(now_);
  if (fit_.iterations >= settings_.iterations || fit_.status != Status::NotConverged) {
    over_ = true;
    return;
  }
  ++fit_.iterations;
  Eigen::MatrixXd damped = now.information;
  damped.diagonal() *= 1.0 + damping_;
  const Eigen::VectorXd step = Cholesky(damped).solve(now.gradient);
  predicted_ = step.dot(now.gradient + damping_ * now.information.diagonal().cwiseProduct(step));
  if (damping_ == kLeastDamping && predicted_ <= settings_.tolerance * now.cost) {
    fit_.status = Status::Converged;  // not even what a parabola predicts is worth a look
    over_ = true;
    return;
  }
  candidate_ = mean_ + step;
}

/// Whether the candidate is better.
void BatchSearch::judge(NormalEquations next) {
  if (!now_) {
    now_ = std::move(next);
  } else if (!(next.cost <= now_->cost)) {
    damping_ = std::max(10.0 * damping_, kFelt);
    fit_.status = damping_ > kMostDamping ? Status::Converged : fit_.status;  // no downhill step at working precision
  } else {
    const double gained = now_->cost - next.cost;
    fit_.status = gained <= settings_.tolerance * now_->cost ? Status::Converged : fit_.status;
    mean_ = candidate_;
    now_ = std::move(next);
    const double ratio = gained / predicted_;
    damping_ = std::max(damping_ * std::max(0.1, 1.0 - std::pow(2.0 * ratio - 1.0, 3)), kLeastDamping);
  }
  propose();
}

bool BatchSearch::advance(std::size_t segments) {
  for (std::size_t i = 0; i < segments && !over_; ++i) {
    const BatchDatum& datum = data_[at_.size()];
    at_.push_back(linearize_segment(model_, candidate_, datum.inputs, datum.segment));
    if (at_.size() == data_.size()) {
      judge(normal_equations(std::exchange(at_, {})));
    }
  }
  return !over_;
}

BatchFit BatchSearch::result() && {
  NormalEquations& now = present(now_);
  fit_.cost = now.cost;
  fit_.at = std::move(now.at);
  fit_.estimate = {mean_, Cholesky(now.information).inverse()};
  return std::move(fit_);
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
