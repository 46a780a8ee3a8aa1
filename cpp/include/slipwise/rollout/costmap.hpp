// SPDX-License-Identifier: Apache-2.0
// A map of cost, or of clearance, that is sampled along rollouts.
#pragma once

#include <cstddef>
#include <span>

namespace slipwise {

/// Square cells in rows of growing x; rows stand in order of growing y. The cell of a point is the one it lies in.
struct Costmap {
  std::span<const float> cells;  ///< [rows * columns], row after row
  std::size_t rows = 0;
  std::size_t columns = 0;
  double resolution = 1.0;  ///< side of a cell [m]
  double origin_x = 0.0;    ///< corner of the first cell [m]
  double origin_y = 0.0;    ///< [m]
  float outside = 0.0F;     ///< value beyond the map
};

/// \throws std::invalid_argument when the map has no cells, too many or too few of them, or a resolution that is no
/// positive number.
void check_costmap(const Costmap& map);

}  // namespace slipwise
