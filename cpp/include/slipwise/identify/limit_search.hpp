// SPDX-License-Identifier: Apache-2.0
// Which limits the wheel speeds show: a profile of each over candidates from the data, the best taken one by one.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "slipwise/identify/limited_actuator_fit.hpp"

namespace slipwise {

struct LimitSearchSettings {
  /// What a limit must gain in -2 log likelihood, for residuals that are not alike. Chance alone gives 20 to one of
  /// 100 000 limits looked for.
  double least_gain = 20.0;
};

/// A limit that the data show; the lag of slew rates is one too, which gains over having these in front of the lag.
struct FoundLimit {
  LimitedAxis axis;
  LimitKind kind;
  double value;  ///< [m/s, rad/s, m/s^2, rad/s^2 or s]
  double std;    ///< of the value
  double gain;   ///< of having it over not having it, in -2 log likelihood
};

/// What the commands reached in an axis: beyond it no limit can show.
struct AxisReach {
  double slowest = 0.0;  ///< command that is not zero
  double fastest = 0.0;  ///< command
  double step = 0.0;     ///< from one command to the next
};

struct LimitSearch {
  LimitedActuator drive;          ///< with the found limits alone
  std::vector<FoundLimit> found;  ///< empty: the data show none
  double wheel_separation_std;    ///< [m] of the separation of the sides; zero where these have no limits
  std::array<AxisReach, kLimitedAxes.size()> reach;
};

/// The limits that the wheels show. The search goes on from `before`, such as what was found in earlier records.
/// \throws std::invalid_argument when there are fewer than 20 twists to explain.
LimitSearch find_limits(std::span<const WheelRecord> records, const PriorSettings& prior, double wheel_separation,
                        const LimitSearchSettings& settings,
                        const std::optional<LimitedActuator>& before = std::nullopt);

}  // namespace slipwise
