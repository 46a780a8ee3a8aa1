// SPDX-License-Identifier: Apache-2.0
// Prediction along the exact law, and scalar updates.
#include "slipwise/filter/hitch_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

constexpr double kShortest = 0.1;  // of the length given

}  // namespace

HitchFilter::HitchFilter(const HitchFilterSettings& settings)
    : rate_psd_(settings.rate_psd),
      shortest_(kShortest * settings.trailer.length),
      state_(0.0, settings.trailer.length, settings.trailer.hitch_offset) {
  const Eigen::Vector3d std(settings.psi_std, settings.length_std, settings.hitch_offset_std);
  if (!(std.minCoeff() > 0.0) || !(settings.trailer.length > 0.0) || !(settings.rate_psd >= 0.0)) {
    throw std::invalid_argument("a trailer's length and all its deviations must be positive");
  }
  covariance_ = std.cwiseAbs2().asDiagonal();
}

void HitchFilter::advance(const BodyTwist& twist, double duration) {
  const HitchStep step = hitch_after(trailer(), state_[0], twist, duration);
  Eigen::Matrix3d by = Eigen::Matrix3d::Identity();
  by.row(0) = step.by;
  state_[0] = step.psi;
  covariance_ = (by * covariance_ * by.transpose()).eval();
  const bool moves = twist.v != 0.0 || twist.vy != 0.0 || twist.omega != 0.0;
  covariance_(0, 0) += moves ? rate_psd_ * duration : 0.0;
}

double HitchFilter::measure(double psi, double std) {
  if (!std::isfinite(psi) || !(std > 0.0)) {
    throw std::invalid_argument("a hitch angle needs a finite value and a positive deviation [rad]");
  }
  const double innovation = wrap_angle(psi - state_[0]);
  const double variance = covariance_(0, 0) + std * std;
  const Eigen::Vector3d gain = covariance_.col(0) / variance;
  state_ += gain * innovation;
  state_[1] = std::max(state_[1], shortest_);
  // Joseph's form keeps the covariance symmetric and positive.
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity();
  left.col(0) -= gain;
  covariance_ = (left * covariance_ * left.transpose() + std * std * gain * gain.transpose()).eval();
  return innovation * innovation / variance;
}

}  // namespace slipwise
