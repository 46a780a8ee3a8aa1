// SPDX-License-Identifier: Apache-2.0
// How uncertain the poses of rollouts are: parameters, the slip disturbance and slip noise (derivations/rollouts.md).
#pragma once

#include <span>
#include <type_traits>

#include "slipwise/rollout/path_noise.hpp"

namespace slipwise {

/// Writes the covariance of every pose, (xx, xy, yy, xt, yt, tt) of the world chart, into `out`
/// [6 * periods * rollouts]: six blocks of rows of periods. The tangents of what is not known go along with the
/// rollouts in their lanes; they are exact derivatives, where a path has one. Where it has none - a speed of zero, an
/// edge between surfaces that is reached - they are those on one side, or the mean of both. Limits of a drive pass on
/// what a gain changes of the input that keeps the start's speed until the first command acts, not in ramps after it.
/// \param growth what the covariances of each period grow by; of all by nothing where there are none.
/// \throws std::invalid_argument as rollout_batch does, and when the uncertainty or the length of `out` or `growth`
/// does not fit. Float and double.
template <typename Scalar>
void rollout_covariance(const UncertainModel& model, const RolloutBatch<Scalar>& batch,
                        std::span<std::type_identity_t<Scalar>> out, std::span<const double> growth = {},
                        const RolloutOptions& options = {});

}  // namespace slipwise
