// SPDX-License-Identifier: Apache-2.0
// What lies ahead is the plane of the first attitude, and nothing that is measured later.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <variant>

#include "slipwise/segment/foreseen_ground.hpp"

namespace slipwise {
namespace {

TEST_CASE("of an attitude measured along a segment the plane at its start is foreseen, whatever comes later") {
  const auto measured = std::make_shared<const Ground>(MeasuredTilts{{{1.0, 0.1, -0.2}, {2.0, 0.3, 0.4}}});
  const auto ahead = foreseen_ground(measured);
  REQUIRE(ahead);
  const auto& plane = std::get<Grade>(*ahead);
  CHECK(plane.rise_x == doctest::Approx(std::tan(0.2)));
  CHECK(plane.rise_y == doctest::Approx(std::tan(0.1) / std::cos(0.2)));
}

TEST_CASE("a plane is known before, and level ground stays level") {
  const auto plane = std::make_shared<const Ground>(Grade{.rise_x = 0.1, .rise_y = 0.2});
  CHECK(foreseen_ground(plane) == plane);
  CHECK(foreseen_ground(nullptr) == nullptr);
  CHECK(foreseen_ground(std::make_shared<const Ground>(MeasuredTilts{})) == nullptr);
}

}  // namespace
}  // namespace slipwise
