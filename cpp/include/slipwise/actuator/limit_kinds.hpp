// SPDX-License-Identifier: Apache-2.0
// The table of limits that an axis of the drive may have: model files, searches, bindings and words go by it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "slipwise/actuator/command_limits.hpp"

namespace slipwise {

enum class LimitKind : std::uint8_t { DeadBand, Saturation, SlewRateUp, SlewRateDown, SlewRateLag };
/// Those that a search looks for one by one; the lag comes with the rates.
inline constexpr std::array kLimitKinds{LimitKind::DeadBand, LimitKind::Saturation, LimitKind::SlewRateUp,
                                        LimitKind::SlewRateDown};

/// A kind of limit.
struct LimitRow {
  const char* name;            ///< of the field, also in a model file
  double AxisLimits::* value;  ///< what is not limited has that of `AxisLimits{}`
  int per_second;              ///< its unit is that of the axis over seconds to this power; of -1, seconds alone
  const char* words;           ///< before the number in a sentence: "speed at most 0.5 m/s"
};
/// Those of `LimitKind` in its order, and behind them those that are given alone.
inline constexpr std::array kLimits{
    LimitRow{.name = "dead_band", .value = &AxisLimits::dead_band, .per_second = 0, .words = "dead band below"},
    LimitRow{.name = "saturation", .value = &AxisLimits::saturation, .per_second = 0, .words = "at most"},
    LimitRow{
        .name = "slew_rate_up", .value = &AxisLimits::slew_rate_up, .per_second = 1, .words = "acceleration at most"},
    LimitRow{
        .name = "slew_rate_down", .value = &AxisLimits::slew_rate_down, .per_second = 1, .words = "braking at most"},
    LimitRow{
        .name = "slew_rate_lag", .value = &AxisLimits::slew_rate_lag, .per_second = -1, .words = "behind a lag of"}};

inline const LimitRow& row_of(LimitKind kind) { return kLimits.at(static_cast<std::size_t>(kind)); }

}  // namespace slipwise
