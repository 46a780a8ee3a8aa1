// SPDX-License-Identifier: Apache-2.0
#include "slipwise/online/hold_times.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace slipwise;

TEST_CASE("steps are held for their length, zero and what comes after a gap is not") {
  HoldTimes held(0.5);
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.05 * i;
    const bool drives = static_cast<int>(t) % 5 < 2;  // 2 s of each 5 s
    if (static_cast<int>(t) % 100 >= 90) {
      continue;
    }
    held.push({t, {.v = drives ? 0.5 : 0.0, .omega = std::sin(t)}});
  }
  held.restart();
  const auto [speed, turn] = held.found();
  CHECK(speed == doctest::Approx(2.0).epsilon(0.05));
  CHECK(turn > 0.3);
  CHECK(turn < 1.5);  // a sine goes on
}

TEST_CASE("a robot that was never commanded has no held input") {
  HoldTimes held(0.5);
  held.push({0.0, {}});
  held.push({10.0, {}});
  held.restart();
  CHECK(held.found() == std::array{0.0, 0.0});
}
