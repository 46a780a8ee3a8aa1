// SPDX-License-Identifier: Apache-2.0
// Student's t around a predicted pose: which share its ellipsoids hold.
#pragma once

namespace slipwise {

inline constexpr double kLeastDof = 2.5;   ///< degrees of freedom; with 2 and less there is no covariance
inline constexpr double kMostDof = 100.0;  ///< as good as normal

/// Probability of (x, y, yaw) to lie within a squared Mahalanobis distance, counted in the covariance, which is
/// dof / (dof - 2) times the scale matrix; 3 squared / dof in the scale matrix is Fisher's F(3, dof).
double fraction_inside(double squared, double dof);

}  // namespace slipwise
