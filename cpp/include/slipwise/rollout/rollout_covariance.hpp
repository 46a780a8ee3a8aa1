// SPDX-License-Identifier: Apache-2.0
// How uncertain the poses of rollouts are: parameters, the slip disturbance and slip noise (derivations/rollouts.md).
#pragma once

#include <span>

#include "slipwise/rollout/path_noise.hpp"

namespace slipwise {

/// Writes the covariance of every pose, (xx, xy, yy, xt, yt, tt) of the world chart, into `out`
/// [6 * periods * rollouts]: six blocks of rows of periods. It costs two rollouts in double per parameter and per
/// disturbed term, and one for the drive alone.
/// \throws std::invalid_argument as rollout_batch does, and when the uncertainty or the length of `out` does not fit.
void rollout_covariance(const UncertainModel& model, const RolloutBatch<double>& batch, std::span<double> out,
                        const RolloutOptions& options = {});

}  // namespace slipwise
