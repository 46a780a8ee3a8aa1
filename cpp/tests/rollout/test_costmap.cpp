// SPDX-License-Identifier: Apache-2.0
// Maps that cannot be sampled are refused, and the numbers that are wrong are said.
#include <doctest/doctest.h>

#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "slipwise/rollout/costmap.hpp"

namespace slipwise {
namespace {

const std::vector<float> kCells(6, 1.0F);

std::string refusal(const Costmap& map) {
  try {
    check_costmap(map);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("a map has rows times columns cells") {
  CHECK(refusal({.cells = kCells, .rows = 2, .columns = 3}).empty());
  CHECK(refusal({.cells = kCells, .rows = 3, .columns = 3}) ==
        "a costmap of 3 rows of 3 cells cannot hold 6 cells; give rows * columns, at least one");
  CHECK_FALSE(refusal({.cells = kCells, .rows = 1, .columns = 3}).empty());
  CHECK_FALSE(refusal({}).empty());
  CHECK_FALSE(refusal({.cells = kCells, .rows = 0, .columns = 6}).empty());
}

TEST_CASE("a map has a positive resolution and a finite origin") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (const double wrong : {0.0, -0.1, kNan, kEndless}) {
    CHECK(refusal({.cells = kCells, .rows = 2, .columns = 3, .resolution = wrong}).find("resolution") !=
          std::string::npos);
  }
  for (const double wrong : {kNan, -kEndless}) {
    CHECK(refusal({.cells = kCells, .rows = 2, .columns = 3, .origin_x = wrong}).find("origin") != std::string::npos);
    CHECK(refusal({.cells = kCells, .rows = 2, .columns = 3, .origin_y = wrong}).find("origin") != std::string::npos);
  }
}

}  // namespace
}  // namespace slipwise
