// SPDX-License-Identifier: Apache-2.0
// The slip rates that a basis and its parameters predict for a state, and how sure they are.
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/slip/basis.hpp"

namespace slipwise {

/// Slip rates (forward [m/s], left [m/s], yaw [rad/s]), ADDED to the commanded twist (thesis 3.1, 6.9).
Eigen::Vector3d slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha, const SlipState& state);

/// The same from features that are already known (Basis::features).
Eigen::Vector3d slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                          std::span<const double> features);

/// Slopes of the slip rates by the drive (v, omega).
Eigen::Matrix<double, 3, 2> slip_rate_by_drive(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                               const SlipState& state);

/// Slopes of the slip rates by the heading in the frame of the poses [1/rad].
Eigen::Vector3d slip_rate_by_heading(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                     const SlipState& state);

/// Slopes of the slip rates by the sideways speed.
Eigen::Vector3d slip_rate_by_sideways(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                      const SlipState& state);

struct SlipRateLinearization {
  Eigen::Vector3d slip;
  Eigen::Matrix<double, 3, 2> by_drive;                   ///< derivatives by (v, omega)
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_parameter;  ///< derivatives by alpha
};

SlipRateLinearization linearize_slip_rate(const Basis& basis, const Eigen::Ref<const Eigen::VectorXd>& alpha,
                                          const SlipState& state);

/// Covariance of the slip rates that follows from the covariance of the parameters.
Eigen::Matrix3d slip_rate_covariance(const Basis& basis, const Eigen::Ref<const Eigen::MatrixXd>& covariance,
                                     const SlipState& state);

}  // namespace slipwise
