// SPDX-License-Identifier: Apache-2.0
// The slip of one surface beside what is the robot's: remembered, recalled, joined, and guessed from other surfaces.
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/filter/prior.hpp"

namespace slipwise {

/// The posterior of the slip parameters of one surface, given the parameters of the robot. Lags, delays, clock and
/// sensor are learned on over all surfaces; what they have become since moves the slip by what it was worth
/// (derivations/surfaces.md).
struct SurfaceSlip {
  Eigen::VectorXd mean;        ///< [slip] where the robot's parameters are `robot`
  Eigen::MatrixXd covariance;  ///< [slip, slip] were the robot's parameters known
  Eigen::MatrixXd by_robot;    ///< [slip, robot] how the mean moves with them
  Eigen::VectorXd robot;       ///< [robot]
  Eigen::VectorXd prior_std;   ///< [slip] of the slip prior under which it was learned
  ReferenceSpeeds speeds{};    ///< of that prior
  NoiseScale noise_scale = NoiseScale();
};

/// A surface that slip may be that of from now on.
struct RecalledSlip {
  SurfaceSlip slip;
  double probability;
};

/// Splits a joint posterior whose first `prior_std.size()` parameters are slip; `inflation` [parameters] are factors of
/// the standard deviations that the reported covariance has beside this one.
SurfaceSlip surface_of(const Estimate& estimate, const Eigen::VectorXd& inflation, const Eigen::VectorXd& prior_std,
                       const ReferenceSpeeds& speeds);

/// The joint posterior of this surface's slip and of the robot as it is known now, [robot].
Estimate joined_with(const SurfaceSlip& surface, const Eigen::Ref<const Eigen::VectorXd>& robot,
                     const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// What two memories of one surface say together; the prior that both started from counts once.
SurfaceSlip merged(const SurfaceSlip& a, const SurfaceSlip& b);

/// The prior of a surface that was never driven: mean and spread of those that were, by empirical Bayes, shrunk to the
/// prior of a first drive, which counts as two surfaces. `robot` are the robot's parameters now; `first_std` [slip] and
/// `speeds` are of the prior of a first drive.
SurfaceSlip shrunk_prior(std::span<const SurfaceSlip> known, const Eigen::Ref<const Eigen::VectorXd>& robot,
                         const Eigen::VectorXd& first_std, const ReferenceSpeeds& speeds);

}  // namespace slipwise
