// SPDX-License-Identifier: Apache-2.0
// How sure a lag is that is taken as one of a few candidates.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

namespace slipwise {

/// Of the candidate `best`, by the logarithms of all likelihoods [lags]: how far the others lie, as probable as they
/// are, and between the candidates where a parabola through the nearest three has its top.
double lag_variance(std::span<const double> lags, const Eigen::VectorXd& logarithm, std::size_t best);

/// Before anything was learned: any of the candidates.
double prior_lag_variance(std::span<const double> lags);

}  // namespace slipwise
