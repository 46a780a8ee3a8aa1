// SPDX-License-Identifier: Apache-2.0
// Prior and noise around any estimator, as CausalFilter has them around the IEKF.
#include "slipwise/thesis/following_estimator.hpp"

#include <cmath>

namespace slipwise {
namespace {

constexpr double kSpeedChange = 0.1;  // as in CausalFilter

EstimatorSettings with_noise(EstimatorSettings settings, const CausalFilterSettings& filter) {
  settings.noise = filter.noise.shape;
  settings.iekf = filter.iekf;
  return settings;
}

bool far_apart(double a, double b) { return std::abs(std::log(a / b)) > kSpeedChange; }

}  // namespace

FollowingEstimator::FollowingEstimator(std::string_view name, const MotionModel& model,
                                       const CausalFilterSettings& filter, EstimatorSettings settings)
    : settings_(filter),
      noise_scale_(filter.noise),
      estimator_(
          make_estimator(name, model, prior_estimate(model, reference_, filter.prior), with_noise(settings, filter))) {}

void FollowingEstimator::follow() {
  const ReferenceSpeeds now = driven_.reference();
  if (!far_apart(now.v, reference_.v) && !far_apart(now.omega, reference_.omega)) {
    return;
  }
  const double fraction = settings_.prior.slip_fraction;
  const Eigen::VectorXd old_std = slip_prior_std(model().basis(), reference_, fraction);
  if (estimator_.change_prior(old_std, slip_prior_std(model().basis(), now, fraction))) {
    reference_ = now;  // otherwise the old prior stays in force
  }
}

Eigen::VectorXd FollowingEstimator::prior_std() const {
  return prior_estimate(model(), reference_, settings_.prior).covariance.diagonal().cwiseSqrt();
}

IekfUpdate FollowingEstimator::learn(const InputHistory& inputs, const Segment& segment) {
  driven_.see(inputs, segment);
  follow();
  const SegmentPath path = integrate_segment(model(), running().mean, inputs, segment);
  const RowsCovariance expected =
      segment_noise(path, rows_of(segment.measured), settings_.noise.shape, Eigen::Vector3d::Ones());
  IekfUpdate update = estimator_.learn(inputs, segment);
  noise_scale_.learn(linearize_segment(model(), running().mean, inputs, segment), running().covariance, segment,
                     expected.diagonal());
  estimator_.scale_noise(noise_scale_.value());
  return update;
}

}  // namespace slipwise
