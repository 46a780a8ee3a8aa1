// SPDX-License-Identifier: Apache-2.0
// The commands of an axis of the drive, and its measurements.
#pragma once

#include <span>
#include <vector>

#include "slipwise/identify/limited_actuator_fit.hpp"

namespace slipwise {

/// A command in an axis.
struct Asked {
  double speed;
  SideCommand of_side;  // of the sides alone
};

/// Sorted sizes of both.
struct AxisRange {
  std::vector<Asked> commands;  // not zero, distinct
  std::vector<double> speeds;
  std::vector<double> rates;
  double step = 0.0;
};

AxisRange axis_range(std::span<const WheelRecord> records, const CommandLimits& limits, LimitedAxis axis);

}  // namespace slipwise
