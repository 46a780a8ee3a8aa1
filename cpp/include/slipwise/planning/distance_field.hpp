// SPDX-License-Identifier: Apache-2.0
// How far it is from every cell of a map to the nearest occupied one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slipwise {

/// Exact distances between the centres of cells [m], row by row; `nothing` where no cell is occupied.
/// \throws std::invalid_argument when the sizes do not fit or the side of a cell is not positive.
std::vector<float> distance_field(std::span<const std::uint8_t> occupied, std::size_t columns, double resolution,
                                  float nothing);

}  // namespace slipwise
