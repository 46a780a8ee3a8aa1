// SPDX-License-Identifier: Apache-2.0
// Slip noise and start uncertainty from how steady paths scatter: the thesis's objective and Fisher scoring.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/thesis/steady_segment.hpp"

namespace slipwise {

/// Deviations around the mean of the segments at each time, or around the best-fit curve (both are in 4.9).
enum class ScatterCentre : std::uint8_t { Mean, Curve };
/// Thesis: plain squares of the scatter at each time (4.13). Fisher: weighted by the scatter's own covariance.
enum class NoiseObjective : std::uint8_t { Thesis, Fisher };

/// Segments of one command at common times.
struct NoiseGroup {
  BodyTwist twist;                          ///< the best-fit curve's: command and slip
  std::vector<double> times;                ///< [K] positive and increasing [s]
  std::vector<Eigen::Matrix3Xd> residuals;  ///< per segment [3, K]: measured - best-fit charts
};

struct NoiseFitSettings {
  NoiseObjective objective = NoiseObjective::Fisher;
  ScatterCentre centre = ScatterCentre::Mean;
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();  ///< known variance of each later measured pose [m^2, m^2, rad^2]
  int iterations = 100;                            ///< at most
  double tolerance = 1e-8;  ///< change, relative to the standard deviations, that counts as settled
};

struct NoiseFit {
  SteadyNoise noise;                       ///< psd and start as fitted, pose as given
  Eigen::Matrix<double, 6, 6> covariance;  ///< of (psd, start), as if none were held at zero
  bool scatter_definite;                   ///< whether the scatter of every group at every time has rank 3
  int iterations;                          ///< used
  Status status;
};

/// Scatter matrix (4.9) of the stacked charts, [3K, 3K]; its diagonal blocks are those of the single times.
/// \throws std::invalid_argument with fewer than three segments, or sizes that do not fit.
Eigen::MatrixXd scatter_matrix(const NoiseGroup& group, ScatterCentre centre);

/// Fits one noise to all groups. A scatter without rank 3 is used as it is: it is never inverted.
/// \throws std::invalid_argument as `scatter_matrix`; when segments do not scatter; when noises cannot be
/// distinguished.
NoiseFit fit_noise(std::span<const NoiseGroup> groups, const NoiseFitSettings& settings = {});

}  // namespace slipwise
