// SPDX-License-Identifier: Apache-2.0
// The causal filter of one model.
#include "slipwise/estimate/causal_filter.hpp"

#include <algorithm>
#include <cmath>

#include "slipwise/estimate/heavy_tails.hpp"

namespace slipwise {
namespace {

constexpr double kSpeedChange = 0.1;  // the prior follows the speeds when their logarithm moves by more than this

bool far_apart(double a, double b) { return std::abs(std::log(a / b)) > kSpeedChange; }

}  // namespace

CausalFilter::CausalFilter(MotionModel model, const CausalFilterSettings& settings)
    : model_(std::move(model)), settings_(settings), noise_scale_(settings.noise) {
  follow({.v = 1.0, .omega = 1.0});
  started_ = false;
}

void CausalFilter::follow(const ReferenceSpeeds& speeds) {
  Eigen::VectorXd std = slip_prior_std(model_.basis(), speeds, settings_.prior.slip_fraction);
  if (!started_) {
    estimate_ = prior_estimate(model_, speeds, settings_.prior);
  } else if (far_apart(speeds.v, speeds_.v) || far_apart(speeds.omega, speeds_.omega)) {
    std::optional<Estimate> changed = change_slip_prior(estimate_, slip_std_, std);
    if (!changed) {
      return;  // the old prior stays in force
    }
    estimate_ = std::move(*changed);
  } else {
    return;
  }
  started_ = true;
  speeds_ = speeds;
  slip_std_ = std::move(std);
}

Eigen::VectorXd CausalFilter::prior_std() const {
  Estimate prior = prior_estimate(model_, speeds_, settings_.prior);
  return prior.covariance.diagonal().cwiseSqrt();
}

void CausalFilter::forget(double share) {
  const Eigen::Index slip = model_.slip_size();
  const double keep = std::sqrt(1.0 - share);
  estimate_.covariance.topRows(slip) *= keep;
  estimate_.covariance.leftCols(slip) *= keep;
  estimate_.covariance.diagonal().head(slip) += share * slip_std_.cwiseAbs2();
  noise_scale_.hurry();
}

IekfUpdate CausalFilter::learn(const InputTrack& inputs, const Segment& segment, const ReferenceSpeeds& speeds) {
  follow(speeds);
  const SegmentPath path = integrate_segment(model_, estimate_.mean, inputs, segment);
  const Eigen::Matrix3d expected =
      slip_covariance(path, settings_.noise.shape) + pose_noise_covariance(segment.measured, settings_.noise.shape);
  IekfUpdate update = iekf_update(model_, estimate_, inputs, segment, scaled_covariance(expected, noise_scale_.value()),
                                  settings_.iekf);
  estimate_ = update.estimate;
  noise_scale_.learn(model_, estimate_, inputs, segment, expected.diagonal());
  return update;
}

Eigen::Matrix3d prediction_covariance(const SegmentLinearization& at,
                                      const Eigen::Ref<const Eigen::MatrixXd>& parameters, const MotionNoise& shape,
                                      const Eigen::Vector3d& scale) {
  return at.by_parameter * parameters * at.by_parameter.transpose() +
         segment_noise(at.path, at.predicted, shape, scale);
}

}  // namespace slipwise
