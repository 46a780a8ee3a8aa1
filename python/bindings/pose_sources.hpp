// SPDX-License-Identifier: Apache-2.0
// What bindings say of sources of poses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "slipwise/online/known_sources.hpp"

namespace slipwise::bindings {

/// Estimates of a pose source.
struct LearnedSource {
  Estimate calibration;                            ///< lateness [s], x, y [m], yaw [rad]
  std::size_t segments;                            ///< learned between its poses
  Eigen::Matrix<double, Eigen::Dynamic, 3> noise;  ///< of each fix, factors of the standard deviations
  std::vector<bool> seen;                          ///< of each fix, whether there was a segment
};

std::vector<LearnedSource> learned_sources(const KnownSources& sources, const Eigen::Vector3d& scale);

/// \throws std::invalid_argument where there is no such fix.
PoseFix pose_fix(std::size_t number);

}  // namespace slipwise::bindings
