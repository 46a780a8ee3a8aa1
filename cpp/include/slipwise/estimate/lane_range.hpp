// SPDX-License-Identifier: Apache-2.0
// What is asked of a lane of the drive, and what is measured of it.
#pragma once

#include <span>
#include <vector>

#include "slipwise/estimate/limited_drive_fit.hpp"

namespace slipwise {

/// A command in a lane.
struct Asked {
  double speed;
  SideCommand of_side;  // of the sides alone
};

/// Sorted sizes of both.
struct LaneRange {
  std::vector<Asked> commands;  // not zero, distinct
  std::vector<double> speeds;
  std::vector<double> rates;
  double step = 0.0;
};

LaneRange lane_range(std::span<const DriveRecord> records, const CommandLimits& limits, LimitedAxis lane);

}  // namespace slipwise
