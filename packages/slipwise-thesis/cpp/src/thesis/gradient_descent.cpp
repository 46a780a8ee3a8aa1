// SPDX-License-Identifier: Apache-2.0
// The damped, weighted step of (6.12).
#include "slipwise/thesis/gradient_descent.hpp"

#include <utility>

#include "slipwise/linear/innovation.hpp"

namespace slipwise {

GradientDescent::GradientDescent(MotionModel model, Estimate prior, const EstimatorSettings& settings)
    : model_(std::move(model)), settings_(settings.gradient_descent), estimate_(std::move(prior)) {}

IekfUpdate GradientDescent::learn(const InputHistory& inputs, const Segment& segment) {
  const auto at = linearize_segment(model_, estimate_.mean, inputs, segment);
  const auto jacobian = segment_jacobian(settings_.jacobian, model_, at, segment);
  const Eigen::VectorXd metric = estimate_.covariance.diagonal();
  RowsCovariance damped = jacobian * metric.asDiagonal() * jacobian.transpose();
  damped.diagonal().array() += settings_.damping;
  const Rows residual = error_of(segment, at);  // (6.4)
  const Rows solved = solve_innovation(damped, residual);
  estimate_.mean += settings_.learning_rate * metric.asDiagonal() * (jacobian.transpose() * solved);  // (6.12)
  return {.estimate = estimate_,
          .innovation = residual,
          .innovation_covariance = damped,
          .nis = residual.dot(solved),
          .weight = settings_.learning_rate,
          .status = Status::Converged};
}

bool GradientDescent::change_prior(const Eigen::VectorXd& /*old_std*/, const Eigen::VectorXd& new_std) {
  estimate_.covariance.diagonal().head(new_std.size()) = new_std.cwiseAbs2();
  return true;
}

}  // namespace slipwise
