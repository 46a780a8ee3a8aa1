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

namespace slipwise {
namespace {

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Of the information's diagonal: what hardly slows the last steps, what shortens a step at all, and what leaves none.
constexpr double kLeastDamping = 1e-4, kFelt = 0.1, kMostDamping = 1e12;

/// Normal equations of the robust MAP problem at one point.
struct NormalEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;  ///< of half the cost, downhill
  double cost;
  std::vector<SegmentLinearization> at;  ///< the data
};

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

/// What is new in the error of a datum, given that of the one before: a block of the Cholesky factor of all errors.
struct NewError {
  Eigen::Matrix3d by_before;          ///< of what was new in the one before, how much comes again
  Eigen::LLT<Eigen::Matrix3d> noise;  ///< of what is new
};

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

class BatchProblem {
 public:
  BatchProblem(const MotionModel& model, const Estimate& prior, std::span<const BatchDatum> data, double huber)
      : model_(model),
        prior_(prior),
        data_(data),
        errors_(new_errors(data)),
        huber_(huber),
        prior_information_(Cholesky(prior.covariance).inverse()) {}

  NormalEquations linearize(const Eigen::VectorXd& mean) const {
    std::vector<SegmentLinearization> at;
    at.reserve(data_.size());
    for (const BatchDatum& datum : data_) {
      at.push_back(linearize_segment(model_, mean, *datum.inputs, datum.segment));
    }
    return normal_equations(mean, std::move(at));
  }

  NormalEquations normal_equations(const Eigen::VectorXd& mean, std::vector<SegmentLinearization> data_at) const {
    const Eigen::VectorXd back = prior_.mean - mean;
    NormalEquations equations{prior_information_, prior_information_ * back, back.dot(prior_information_ * back),
                              std::move(data_at)};
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
    Jacobian by_parameter = Jacobian::Zero(3, model_.size());
    for (std::size_t i = 0; i < data_.size(); ++i) {
      const SegmentLinearization& at = equations.at[i];
      r = data_[i].segment.measured.vector() - at.predicted.vector() - errors_[i].by_before * r;
      by_parameter = at.by_parameter - errors_[i].by_before * by_parameter;
      const Eigen::LLT<Eigen::Matrix3d>& noise = errors_[i].noise;
      const HuberLoss loss = huber_loss(r.dot(noise.solve(r)), huber_);
      const Jacobian weighted = noise.solve(by_parameter) * loss.weight;
      equations.cost += loss.cost;
      equations.information.noalias() += by_parameter.transpose() * weighted;
      equations.gradient.noalias() += weighted.transpose() * r;
    }
    return equations;
  }

 private:
  const MotionModel& model_;
  const Estimate& prior_;
  std::span<const BatchDatum> data_;
  std::vector<NewError> errors_;
  double huber_;
  Eigen::MatrixXd prior_information_;
};

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
    if (data[i].inputs == nullptr || !(segment.end > segment.start) || !segment.measured.vector().allFinite() ||
        !Cholesky(data[i].noise).positive_definite()) {
      throw std::invalid_argument("segment " + std::to_string(i) +
                                  " must have inputs, end after it starts, and have finite measurements and a positive "
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

BatchFit batch_fit(const MotionModel& model, const Estimate& prior, std::span<const BatchDatum> data,
                   const BatchSettings& settings, std::vector<SegmentLinearization> at_start) {
  check(model, prior, data, settings.start);
  if (!at_start.empty() && at_start.size() != data.size()) {
    throw std::invalid_argument("of all data or of none the linearisation at the start must be given");
  }
  const BatchProblem problem(model, prior, data, settings.huber);
  Eigen::VectorXd mean = settings.start.size() > 0 ? settings.start : prior.mean;
  NormalEquations now =
      at_start.empty() ? problem.linearize(mean) : problem.normal_equations(mean, std::move(at_start));
  double damping = kLeastDamping;
  BatchFit fit{prior, now.cost, 0, Status::NotConverged, {}};
  while (fit.iterations < settings.iterations && fit.status == Status::NotConverged) {
    ++fit.iterations;
    Eigen::MatrixXd damped = now.information;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::VectorXd step = Cholesky(damped).solve(now.gradient);
    const double promised = step.dot(now.gradient + damping * now.information.diagonal().cwiseProduct(step));
    const double little = settings.tolerance * now.cost;
    if (damping == kLeastDamping && promised <= little) {
      fit.status = Status::Converged;  // not even what a parabola promises is worth a look
      break;
    }
    const Eigen::VectorXd candidate = mean + step;
    NormalEquations next = problem.linearize(candidate);
    if (!(next.cost <= now.cost)) {
      damping = std::max(10.0 * damping, kFelt);
      fit.status = damping > kMostDamping ? Status::Converged : fit.status;  // no downhill step at working precision
      continue;
    }
    const double gained = now.cost - next.cost;
    fit.status = gained <= little ? Status::Converged : fit.status;
    mean = candidate;
    now = std::move(next);
    damping = std::max(damping * std::max(0.1, 1.0 - std::pow(2.0 * gained / promised - 1.0, 3)), kLeastDamping);
  }
  fit.cost = now.cost;
  fit.at = std::move(now.at);
  fit.estimate = {mean, Cholesky(now.information).inverse()};
  return fit;
}

}  // namespace slipwise
