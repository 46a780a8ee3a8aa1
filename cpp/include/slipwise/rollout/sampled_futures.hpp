// SPDX-License-Identifier: Apache-2.0
// Futures drawn from what was learned: parameters from their distribution, slip noise along the way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "slipwise/rollout/path_noise.hpp"

namespace slipwise {

/// Where the drawn poses go, [samples * periods * rollouts] each.
template <typename Scalar>
struct FutureOutputs {
  std::span<Scalar> x;      ///< [m]
  std::span<Scalar> y;      ///< [m]
  std::span<Scalar> theta;  ///< [rad], not wrapped
};

/// Parameters drawn from their distribution, [parameters, samples]; the inflation widens it.
Eigen::MatrixXd draw_parameters(const UncertainModel& model, std::size_t samples, std::uint64_t seed);

/// Each sample drives all commands with parameters of its own, and each of its rollouts has slip noise of its own. The
/// learned factors of (x, y, theta) are taken as those of the forward, sideways and angular slip.
/// The same seed gives the same bytes at any number of threads. Float and double, from the same random numbers.
/// \throws std::invalid_argument as rollout_batch does, when there is no sample, or an output has the wrong length.
template <typename Scalar>
void sample_futures(const UncertainModel& model, const RolloutBatch<Scalar>& batch, std::uint64_t seed,
                    const FutureOutputs<Scalar>& outputs, const RolloutOptions& options = {});

}  // namespace slipwise
