// SPDX-License-Identifier: Apache-2.0
// Rows that a fit of positions makes share one size of noise: they hang together so closely that sizes learned apart
// would weigh what one tells beside another wrongly.
#pragma once

#include <vector>

#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/linear/rows.hpp"
#include "slipwise/sensor/sensor.hpp"

namespace slipwise {

/// Squares of each row, those of a sensor of positions with one ratio to the variances that are `expected`: their mean.
Rows alike_of_positions(const std::vector<Measured>& measured, Rows squared, const Rows& expected);
/// The same of errors, and of what is open beside them.
RowErrors alike_of_positions(const std::vector<Measured>& measured, const RowErrors& errors);

}  // namespace slipwise
