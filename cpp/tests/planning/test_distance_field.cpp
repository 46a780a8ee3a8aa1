// SPDX-License-Identifier: Apache-2.0
// Distances to the nearest occupied cell, against looking at every cell.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "slipwise/planning/distance_field.hpp"

namespace slipwise {
namespace {

double nearest(const std::vector<std::uint8_t>& occupied, std::size_t columns, std::size_t cell) {
  double best = 1e9;
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    if (occupied[i] != 0) {
      const double dx = static_cast<double>(i % columns) - static_cast<double>(cell % columns);
      const double dy = static_cast<double>(i / columns) - static_cast<double>(cell / columns);
      best = std::min(best, std::hypot(dx, dy));
    }
  }
  return best;
}

TEST_CASE("a distance field holds the distance to the nearest occupied cell") {
  std::mt19937_64 random(3);
  for (const auto& [rows, columns, one_in] : {std::tuple{17U, 31U, 40U}, {1U, 50U, 9U}, {40U, 1U, 13U}, {9U, 9U, 2U}}) {
    std::vector<std::uint8_t> occupied(static_cast<std::size_t>(rows) * columns);
    for (auto& cell : occupied) {
      cell = random() % one_in == 0 ? 1 : 0;
    }
    occupied[occupied.size() / 2] = 1;
    const auto field = distance_field(occupied, columns, 0.5, -1.0F);
    for (std::size_t i = 0; i < occupied.size(); ++i) {
      CHECK(field[i] == doctest::Approx(0.5 * nearest(occupied, columns, i)).epsilon(1e-6));
    }
  }
}

TEST_CASE("a map without obstacles has no distances, and a map of the wrong size is refused") {
  const std::vector<std::uint8_t> free(12, 0);
  CHECK(distance_field(free, 4, 0.1, 99.0F) == std::vector<float>(12, 99.0F));
  CHECK_THROWS_AS(distance_field(free, 5, 0.1, 0.0F), std::invalid_argument);
  CHECK_THROWS_AS(distance_field(free, 4, -0.1, 0.0F), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
