// SPDX-License-Identifier: Apache-2.0
// Describes motor currents by their size, spread and ratio to wheel speed.
#pragma once

#include <Eigen/Core>

namespace slipwise {

inline constexpr Eigen::Index kDriveColumns = 4;      ///< left and right current [A], left and right speed [m/s]
inline constexpr Eigen::Index kCurrentFeatures = 16;  ///< numbers of a window

/// Of each side the mean, spread, least and largest current; of their sum mean, spread and change; ratios of the sides,
/// to wheel speed, and the correlation of the sides. Natural logarithms, but for the least currents [A] and the
/// correlation. How fast and how unsteadily the robot is driven is left out: it tells one day's driver from another's,
/// not one surface from another. `samples` [n, 4] are evenly spaced.
/// \throws std::invalid_argument when there are fewer than two, or not of four columns.
Eigen::VectorXd current_features(const Eigen::Ref<const Eigen::MatrixXd>& samples);

}  // namespace slipwise
