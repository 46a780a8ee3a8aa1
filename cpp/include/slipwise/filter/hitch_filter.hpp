// SPDX-License-Identifier: Apache-2.0
// The hitch angle of a trailer as a state, its length and hitch offset as parameters, followed by an extended Kalman
// filter (derivations/trailer.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/vehicle/trailer.hpp"

namespace slipwise {

/// What is thought of a trailer before it is driven, and how exact the law is.
struct HitchFilterSettings {
  Trailer trailer{.length = 1.0, .hitch_offset = 0.0};
  double length_std = 0.3;        ///< [m]
  double hitch_offset_std = 0.3;  ///< [m]
  double psi_std = 0.5;           ///< of the angle at first, about 0 [rad]
  double rate_psd = 1e-4;         ///< white noise of the angle's rate while the vehicle moves [rad^2/s]
};

class HitchFilter {
 public:
  /// \throws std::invalid_argument when a deviation is not positive.
  explicit HitchFilter(const HitchFilterSettings& settings);

  /// The vehicle moves with a twist, slip included, for `duration` [s].
  void advance(const BodyTwist& twist, double duration);
  /// The hitch angle was measured: by an encoder, or as the difference of two headings [rad].
  /// \return the squared innovation over its variance.
  double measure(double psi, double std);

  double psi() const { return state_[0]; }
  Trailer trailer() const { return {.length = state_[1], .hitch_offset = state_[2]}; }
  /// Of (psi, length, hitch offset).
  const Eigen::Matrix3d& covariance() const { return covariance_; }

 private:
  double rate_psd_;
  double shortest_;  ///< [m] no trailer is shorter
  Eigen::Vector3d state_;
  Eigen::Matrix3d covariance_;
};

}  // namespace slipwise
