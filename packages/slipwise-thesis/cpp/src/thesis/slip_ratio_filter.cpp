// SPDX-License-Identifier: Apache-2.0
// The extended Kalman filter of slip ratios and slip angle.
#include "slipwise/thesis/slip_ratio_filter.hpp"

#include <cmath>
#include <stdexcept>

#include "slipwise/filter/linear_update.hpp"
#include "slipwise/linear/innovation.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {
namespace {

Eigen::Vector3d squares(double ratio, double angle) { return {ratio * ratio, ratio * ratio, angle * angle}; }

void check(const SlipRatioFilterSettings& settings) {
  for (const double value : {settings.wheel_separation, settings.prior_ratio_std, settings.prior_angle_std,
                             settings.huber, settings.noise.pose_std_xy, settings.noise.pose_std_yaw}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(
          "the slip-ratio filter needs a positive wheel separation [m], prior standard deviations, Huber threshold and "
          "pose "
          "noise");
    }
  }
  if (!(settings.walk_ratio >= 0.0) || !(settings.walk_angle >= 0.0)) {
    throw std::invalid_argument("the random walk of the slip ratios must not be negative");
  }
}

}  // namespace

MotionModel slip_ratio_model() { return {named_basis("full-linear-6"), {}}; }

SlipRatioLinearization linearize_slip_ratios(const InputHistory& wheels, const Segment& segment, const SlipRatios& slip,
                                             double wheel_separation) {
  const LinearSlip linear = linear_slip(slip, wheel_separation);
  SlipRatioLinearization at{.segment = linearize_segment(slip_ratio_model(), linear.alpha, wheels, segment),
                            .by_slip_ratios = Eigen::Matrix3d::Zero()};
  at.by_slip_ratios = at.segment.by_parameter * linear.by_slip_ratios;
  return at;
}

SlipRatioFilter::SlipRatioFilter(const SlipRatioFilterSettings& settings) : settings_(settings) {
  check(settings);
  estimate_.mean = Eigen::Vector3d::Zero();
  estimate_.covariance = squares(settings.prior_ratio_std, settings.prior_angle_std).asDiagonal();
}

SlipRatioUpdate SlipRatioFilter::learn(const InputHistory& wheels, const Segment& segment) {
  if (!(segment.end > segment.start) || !motion_of(segment.measured).vector().allFinite()) {
    throw std::invalid_argument("a segment must end after it starts and have finite measurements");
  }
  Eigen::Matrix3d prior = estimate_.covariance;
  prior.diagonal() += squares(settings_.walk_ratio, settings_.walk_angle) * (segment.end - segment.start);
  const auto at = linearize_slip_ratios(wheels, segment, slip(), settings_.wheel_separation);
  const Eigen::Matrix3d& h = at.by_slip_ratios;
  const Eigen::Matrix3d noise = slip_covariance(at.segment.path, settings_.noise) +
                                at.segment.path.measurement_noise(rows_of(segment.measured), settings_.noise);
  SlipRatioUpdate update{.innovation = error_of(segment, at.segment),
                         .innovation_covariance = h * prior * h.transpose() + noise,
                         .nis = 0.0,
                         .weight = 1.0};
  update.nis = normalised_square(update.innovation, update.innovation_covariance);
  if (const double sigmas = std::sqrt(update.nis); sigmas > settings_.huber) {
    update.weight = settings_.huber / sigmas;
  }
  const Eigen::Matrix3d weighted = noise / update.weight;
  Eigen::Matrix3d posterior = prior;
  const Eigen::Vector3d mean = estimate_.mean + linear_update(posterior, h, weighted) * update.innovation;
  estimate_.mean = bounded(SlipRatios::from_vector(mean)).vector();
  estimate_.covariance = posterior;
  return update;
}

Estimate SlipRatioFilter::linear_estimate() const {
  const LinearSlip linear = linear_slip(slip(), settings_.wheel_separation);
  return {linear.alpha, linear.by_slip_ratios * estimate_.covariance * linear.by_slip_ratios.transpose()};
}

}  // namespace slipwise
