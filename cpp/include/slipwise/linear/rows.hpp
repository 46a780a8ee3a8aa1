// SPDX-License-Identifier: Apache-2.0
// What is measured of one segment, a row for each number: a few, so that none of it needs memory of its own.
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// A pose, a position and a turn together.
inline constexpr int kMostRows = 7;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows, 1>;
using RowsCovariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostRows, kMostRows>;
using RowsJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostRows, Eigen::Dynamic>;

}  // namespace slipwise
