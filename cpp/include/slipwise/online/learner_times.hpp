// SPDX-License-Identifier: Apache-2.0
// The times that decide what a prediction may use: by stamps, so that results do not depend on how fast a machine is.
#pragma once

#include "slipwise/linear/tuning.hpp"

namespace slipwise {

inline constexpr double kReady = 1.0;         ///< [s] after which a segment has been learned, whatever the latency
inline constexpr double kLookBack = 20.0;     ///< [s] of inputs before a segment; an actuator remembers no more
inline constexpr double kWheelsBack = 3.0;    ///< [s] of wheel speeds before a segment; no clock offset is larger
inline constexpr double kWheelsAhead = 0.15;  ///< [s] of wheel speeds after a segment, whose poses may be stamped early
inline SLIPWISE_TUNING(kRecent, 7.0);         ///< lengths of a segment within which segments tell of the slip now

}  // namespace slipwise
