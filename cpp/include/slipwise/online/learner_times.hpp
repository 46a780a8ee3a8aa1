// SPDX-License-Identifier: Apache-2.0
// The times that decide what a prediction may use: by stamps, so that results do not depend on how fast a machine is.
#pragma once

#include <cstddef>

namespace slipwise {

inline constexpr double kReady = 1.0;           ///< [s] after which a segment has been learned, whatever the latency
inline constexpr double kRecentSeconds = 30.0;  ///< [s] of segments that tell of the slip now, at most
inline constexpr std::size_t kRecent = 6;       ///< segments that tell of it, at most

}  // namespace slipwise
