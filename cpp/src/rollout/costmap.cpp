// SPDX-License-Identifier: Apache-2.0
// What a costmap must be.
#include "slipwise/rollout/costmap.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace slipwise {

void check_costmap(const Costmap& map) {
  if (map.rows == 0 || map.columns == 0 || map.cells.size() != map.rows * map.columns) {
    throw std::invalid_argument("a costmap of " + std::to_string(map.rows) + " rows of " + std::to_string(map.columns) +
                                " cells cannot hold " + std::to_string(map.cells.size()) +
                                " cells; give rows * columns, at least one");
  }
  if (!(map.resolution > 0.0) || !std::isfinite(map.resolution)) {
    throw std::invalid_argument("a costmap's resolution must be a positive number of metres per cell, got " +
                                std::to_string(map.resolution));
  }
  if (!std::isfinite(map.origin_x) || !std::isfinite(map.origin_y)) {
    throw std::invalid_argument("a costmap's origin must be finite");
  }
}

}  // namespace slipwise
