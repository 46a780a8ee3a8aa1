// SPDX-License-Identifier: Apache-2.0
// Segments as they are driven behind limits of the actuator, and whether that predicts them better.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "slipwise/actuator/command_limits.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/filter/noise_scale.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// The segment under what the limits let through of its commands.
DrivenSegment behind(const DrivenSegment& segment, const CommandLimits& limits);

/// The estimates without limits and behind them, of the same data.
struct LimitContest {
  const MotionPosterior& without;
  const MotionPosterior& with;
  const CommandLimits& limits;
  const NoiseSettings& noise;
};

/// Log score of the segments behind the limits over that without limits, each by what it knew before them.
double gain_behind(std::span<const DrivenSegment> segments, const LimitContest& contest);

/// Whether so much gain over so many segments is no chance.
bool is_clear(double gain, std::span<const DrivenSegment> segments);

/// Those that start at `t` [s] or later.
std::vector<DrivenSegment> segments_since(std::span<const DrivenSegment> segments, double t);

}  // namespace slipwise
