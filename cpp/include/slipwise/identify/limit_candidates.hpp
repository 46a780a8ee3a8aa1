// SPDX-License-Identifier: Apache-2.0
// Values of limits that the data of an axis suggest.
#pragma once

#include <vector>

#include "slipwise/actuator/limit_kinds.hpp"
#include "slipwise/identify/axis_range.hpp"

namespace slipwise {

/// Values to try, without a limit of the kind; none where the data say nothing.
std::vector<double> limit_candidates(LimitKind kind, const AxisRange& range);

/// Likely saturation and slew rates all at once, as far as the data say any.
void limit_all(AxisLimits& limits, const AxisRange& range);

}  // namespace slipwise
