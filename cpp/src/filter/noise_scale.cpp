// SPDX-License-Identifier: Apache-2.0
// The running mean of squared residuals over their expected size.
#include "slipwise/filter/noise_scale.hpp"

#include <algorithm>

#include "slipwise/linear/tuning.hpp"

namespace slipwise {
namespace {

SLIPWISE_TUNING(kLeastFraction, 0.1);  // of a squared error that is noise, however much the parameters leave open

}  // namespace

void NoiseScale::learn(const SegmentLinearization& at, const Eigen::MatrixXd& covariance, const Pose2& measured,
                       const Eigen::Vector3d& expected) {
  if (!settings_.adapt) {
    return;
  }
  const Eigen::Vector3d residual = measured.vector() - at.predicted.vector();
  const Eigen::Matrix3d open = at.by_parameter * covariance * at.by_parameter.transpose();
  follow(shown_by(at.path, residual.cwiseAbs2() + open.diagonal(), expected), expected);
}

Eigen::Vector3d NoiseScale::shown_by(const SegmentPath& path, Eigen::Vector3d squared,
                                     const Eigen::Vector3d& expected) const {
  if (path.heading_std) {
    squared.head<2>() = value_.head<2>().cwiseProduct(expected.head<2>());
  }
  return squared;
}

void NoiseScale::learn_prediction(const Eigen::Vector3d& squared, const Eigen::Vector3d& open,
                                  const Eigen::Vector3d& expected) {
  if (settings_.adapt) {
    follow((squared - open).cwiseMax(kLeastFraction * squared), expected);
  }
}

void NoiseScale::follow(const Eigen::Vector3d& squared, const Eigen::Vector3d& expected) {
  segments_ += 1.0;
  const double gain = std::max(1.0 / (segments_ + settings_.prior_segments), 1.0 / settings_.forgetting_time);
  value_ += gain * (squared.cwiseQuotient(expected).cwiseMin(settings_.largest * value_) - value_);
}

}  // namespace slipwise
