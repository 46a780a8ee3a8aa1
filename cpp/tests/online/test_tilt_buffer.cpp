// SPDX-License-Identifier: Apache-2.0
// Attitudes along a segment, and as far as they are known at its start.
#include <doctest/doctest.h>

#include <cmath>
#include <variant>

#include "slipwise/online/tilt_buffer.hpp"

namespace slipwise {
namespace {

TiltBuffer filled() {
  TiltBuffer buffer;
  for (int i = 0; i < 100; ++i) {
    buffer.push({0.1 * i, 0.001 * i, -0.002 * i});
  }
  return buffer;
}

TEST_CASE("a segment's attitudes reach from the last before it to the first after it") {
  const auto ground = filled().along(2.05, 3.05, 0.5);
  REQUIRE(ground);
  const auto& tilts = std::get<MeasuredTilts>(*ground);
  REQUIRE(tilts.at.size() == 12);
  CHECK(tilts.at.front().t == doctest::Approx(2.0));
  CHECK(tilts.at.back().t == doctest::Approx(3.1));
}

TEST_CASE("what lies ahead stands on the plane at its start, whatever is measured later") {
  const auto ground = filled().from(2.05, 0.5);
  REQUIRE(ground);
  const auto& plane = std::get<Grade>(*ground);
  CHECK(plane.rise_x == doctest::Approx(std::tan(0.04)));
  CHECK(plane.rise_y == doctest::Approx(std::tan(0.02) / std::cos(0.04)));
}

TEST_CASE("an attitude that is old, or of the future, tells nothing") {
  CHECK(filled().along(11.0, 12.0, 0.5) == nullptr);
  CHECK(filled().from(-1.0, 0.5) == nullptr);
  CHECK(TiltBuffer().along(0.0, 1.0, 0.5) == nullptr);
}

TEST_CASE("of attitudes closer than 20 ms the first is kept, and old ones are dropped but for the last") {
  TiltBuffer buffer;
  for (int i = 0; i < 1000; ++i) {
    buffer.push({0.001 * i, 0.0, 0.0});
  }
  CHECK(std::get<MeasuredTilts>(*buffer.along(0.0, 1.0, 0.5)).at.size() == 50);
  buffer.drop_before(5.0);
  CHECK(std::get<MeasuredTilts>(*buffer.along(1.0, 1.1, 0.5)).at.size() == 1);
}

TEST_CASE("a nose that points down is pulled forward, and one that lies on its left side is pulled left") {
  CHECK(gravity_of({0.0, 0.0, 0.1}).gx > 0.0);
  CHECK(gravity_of({0.0, -0.1, 0.0}).gy > 0.0);
  CHECK(gravity_of({0.0, 0.0, 0.0}).gx == 0.0);
}

}  // namespace
}  // namespace slipwise
