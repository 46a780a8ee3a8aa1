// SPDX-License-Identifier: Apache-2.0
// Central differences of the integrator along parameters and along what is not known of the slip ahead.
#include "slipwise/disturbance/ahead_prediction.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace slipwise {
namespace {

constexpr double kStep = 1e-5;  // of parameters, and of standard deviations of the slip ahead

Rows end_of(const MotionModel& model, const Eigen::VectorXd& parameters, const DrivenSegment& driven,
            const SlipAhead& ahead) {
  return integrate_segment(model, parameters, driven.inputs, driven.segment, Integrator::Exact, ahead).rows();
}

/// The end where the slip of all stretches has moved along a direction [slip, stretches].
Rows end_along(const MotionModel& model, Eigen::VectorXd parameters, const DrivenSegment& driven, SlipAhead ahead,
               const Eigen::MatrixXd& direction) {
  move_slip(direction, parameters, ahead);
  return end_of(model, parameters, driven, ahead);
}

/// [m] ahead or back
double travelled(const SegmentPath& path) {
  double sum = 0.0;
  for (const Eigen::Vector3d& tangent : path.tangents) {
    sum += std::abs(tangent.x());
  }
  return sum;
}

}  // namespace

SegmentLinearization linearize_ahead(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                     const DrivenSegment& driven, const SlipAhead& ahead) {
  SegmentLinearization found{
      .path = integrate_segment(model, parameters, driven.inputs, driven.segment, Integrator::Exact, ahead),
      .predicted = {},
      .by_parameter = {}};
  found.predicted = found.path.rows();
  found.by_parameter.resize(found.predicted.size(), parameters.size());
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(parameters.size(), i);
    found.by_parameter.col(i) =
        (end_of(model, parameters + step, driven, ahead) - end_of(model, parameters - step, driven, ahead)) /
        (2.0 * kStep);
  }
  return found;
}

ExpectedPose predict_ahead(const DisturbanceFilter& filter, MotionPosterior posterior, const SlipNow& now,
                           const DrivenSegment& driven, const MixedAhead& mixed) {
  const Eigen::Index slip = posterior.model.slip_size();
  if (mixed.slip.size() != slip) {
    throw std::invalid_argument("the slip ahead has " + std::to_string(mixed.slip.size()) +
                                " terms where the model has " + std::to_string(slip));
  }
  auto& [mean, covariance] = posterior.estimate;
  mean.head(slip) = mixed.slip;
  covariance.topRows(slip).setZero();
  covariance.leftCols(slip).setZero();
  const SegmentLinearization at = linearize_ahead(posterior.model, mean, driven, mixed.ahead);
  posterior.noise_scale = mixed.noise_scale_until(travelled(at.path));
  ExpectedPose expected = filter.predict_at(posterior, now, at, driven.segment);
  for (const Eigen::MatrixXd& direction : mixed.directions) {
    const Rows by = (end_along(posterior.model, mean, driven, mixed.ahead, kStep * direction) -
                     end_along(posterior.model, mean, driven, mixed.ahead, -kStep * direction)) /
                    (2.0 * kStep);
    expected.covariance += by * by.transpose();
  }
  return expected;
}

}  // namespace slipwise
