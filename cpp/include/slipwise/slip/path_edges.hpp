// SPDX-License-Identifier: Apache-2.0
// What holds for edges between surfaces along a path wherever they are computed, in lanes too.
#pragma once

#include <cstddef>

namespace slipwise {

inline constexpr std::size_t kMostEdges = 15;  ///< along one path
inline constexpr double kEdgeWidth = 1e-3;     ///< [m] that an edge is wide for a robot that turns on it

}  // namespace slipwise
