// SPDX-License-Identifier: Apache-2.0
// Curvature over the time of a manoeuvre: a clamped cubic B-spline, which stays between its control points.
#pragma once

#include <Eigen/Core>

namespace slipwise {

inline constexpr int kCurvaturePoints = 7;
using CurvatureWeights = Eigen::Matrix<double, 1, kCurvaturePoints>;

/// What each control point weighs at a fraction (0 to 1) of the manoeuvre; not negative, and their sum is 1. The first
/// point is the curvature at the start, the last that at the end.
CurvatureWeights curvature_weights(double fraction);

}  // namespace slipwise
