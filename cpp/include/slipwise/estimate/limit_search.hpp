// SPDX-License-Identifier: Apache-2.0
// Which limits the wheel speeds show: a profile of each over candidates from the data, the best taken one by one.
#pragma once

#include <span>
#include <vector>

#include "slipwise/estimate/limited_drive_fit.hpp"

namespace slipwise {

struct LimitSearchSettings {
  /// What a limit must gain in -2 log likelihood, for residuals that are not alike. Chance alone gives 20 to one of
  /// 100 000 limits looked for.
  double least_gain = 20.0;
};

/// A limit that the data show.
struct FoundLimit {
  int lane;  ///< 0: speed, or both sides; 1: yaw rate
  LimitKind kind;
  double value;  ///< [m/s, rad/s, m/s^2 or rad/s^2]
  double std;    ///< of the value
  double gain;   ///< of having it over not having it, in -2 log likelihood
};

/// What the commands reached in a lane: beyond it no limit can show.
struct LaneReach {
  double slowest;  ///< command that is not zero
  double fastest;  ///< command
  double step;     ///< from one command to the next
};

struct LimitSearch {
  LimitedDrive drive;             ///< with the found limits alone
  std::vector<FoundLimit> found;  ///< empty: the data show none
  double track_std;               ///< [m] of the track between the sides; zero for channels
  std::vector<LaneReach> reach;   ///< per separate lane
};

/// The limits of both channels or of both sides, whichever explain the wheels better.
/// \throws std::invalid_argument when there are fewer than 20 twists to explain.
LimitSearch find_limits(std::span<const DriveRecord> records, const PriorSettings& prior, double track,
                        const LimitSearchSettings& settings);

}  // namespace slipwise
