// SPDX-License-Identifier: Apache-2.0
// How far a fit really scatters where its residuals are not as large, segment by segment, as their noise says.
#pragma once

#include <Eigen/Core>
#include <span>

#include "slipwise/estimate/batch.hpp"
#include "slipwise/estimate/estimate.hpp"

namespace slipwise {

/// Factors of the standard deviations of `fit`, that of `data` after `before`: the sandwich estimator (Huber 1967,
/// White 1980), where the stated noise counts for some residuals too (derivations.md, section 6).
Eigen::VectorXd sandwich_factors(const Estimate& before, const BatchFit& fit, std::span<const BatchDatum> data);

}  // namespace slipwise
