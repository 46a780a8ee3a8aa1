// SPDX-License-Identifier: Apache-2.0
// Constant slip rates of a group of steady paths, by least squares as in (4.1) or weighted by their noise.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/thesis/steady_segment.hpp"

namespace slipwise {

struct SlipRateSettings {
  double length = 1.0;                    ///< L of (4.1): a turn of 1 rad weighs like this distance [m]
  bool angular = true;                    ///< fit the yaw slip; without it translation alone
  std::optional<SteadyNoise> noise = {};  ///< weigh by the inverse of the covariance that this noise causes
  int iterations = 50;                    ///< at most
  double tolerance = 1e-12;               ///< relative decrease of the cost that counts as converged [-]
};

struct SlipRateFit {
  Eigen::Vector3d slip;                     ///< (lon, lat, ang) [m/s, m/s, rad/s]
  Eigen::Matrix3d covariance;               ///< zero for a rate that was not fitted
  double cost;                              ///< (4.1) with L^2, or the weighted cost
  Eigen::Vector3d rms;                      ///< of the residuals (x, y, heading) [m, m, rad]
  std::vector<Eigen::Matrix3Xd> residuals;  ///< per segment: measured - predicted at its times after the first
  int iterations;                           ///< used
  Status status;
};

/// Measured - predicted charts of one segment under a slip, at its times after the first, [3, N - 1]; heading wrapped.
Eigen::Matrix3Xd steady_residuals(const SteadySegment& segment, const Eigen::Vector3d& slip);

/// Without noise the covariance comes from how the segments disagree, and there must be at least two of them.
/// \throws std::invalid_argument when there are too few segments or poses, or their times do not start at 0 and
/// increase.
SlipRateFit fit_slip_rates(std::span<const SteadySegment> segments, const SlipRateSettings& settings = {});

}  // namespace slipwise
