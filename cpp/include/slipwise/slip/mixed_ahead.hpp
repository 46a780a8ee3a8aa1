// SPDX-License-Identifier: Apache-2.0
// Slip along a path whose surfaces are known with probabilities: mean and covariance of the mixture
// (derivations/surfaces.md).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "slipwise/slip/slip_ahead.hpp"

namespace slipwise {

/// The estimate of one surface's slip, and the learned factor of the noise's variances there.
struct SurfaceMoments {
  Eigen::VectorXd slip;        ///< [slip]
  Eigen::MatrixXd covariance;  ///< [slip, slip]
  Eigen::Vector3d noise_scale = Eigen::Vector3d::Ones();
};

/// The moments of slip over all stretches of a path.
struct MixedAhead {
  Eigen::VectorXd slip;  ///< [slip] where the path begins
  SlipAhead ahead;
  /// [slip, stretches] each: slip of all stretches moves along one of them as one, and along each by itself with a
  /// standard deviation of one. Their sum of squares is the covariance.
  std::vector<Eigen::MatrixXd> directions;
  Eigen::MatrixX3d noise_scale;  ///< [stretches, 3] factor of the noise's variances on each

  /// The largest factor of the stretches that a path of this length [m] comes to.
  Eigen::Vector3d noise_scale_until(double travelled) const;
};

/// Each stretch, from one edge to the next, has one surface, drawn by its row of `probabilities` [stretches, surfaces],
/// those of several stretches independently. A surface has the same slip wherever it is.
/// \throws std::invalid_argument when sizes do not fit, a row is not a distribution, or edges do not increase.
MixedAhead mix_ahead(std::vector<double> edges, const Eigen::Ref<const Eigen::MatrixXd>& probabilities,
                     std::span<const SurfaceMoments> surfaces);

}  // namespace slipwise
