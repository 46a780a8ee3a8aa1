// SPDX-License-Identifier: Apache-2.0
// Attitudes in one turn, of sensors that sit upright on the robot or not.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "slipwise/lie/angle.hpp"
#include "slipwise/linear/present.hpp"
#include "slipwise/online/attitude_gate.hpp"

namespace slipwise {
namespace {

constexpr double kPi = std::numbers::pi;
using Kind = AttitudeMounting::Kind;

TEST_CASE("angles come in one turn, whatever branch they were written in") {
  AttitudeGate gate;
  const Tilt tilt = present(gate.level({0.0, 2.0 * kPi - 0.1, 0.05 - 2.0 * kPi}));
  CHECK(tilt.roll == doctest::Approx(-0.1));
  CHECK(tilt.pitch == doctest::Approx(0.05));
  const Tilt beyond = present(gate.level({0.0, kPi - 0.1, kPi - 0.2}));  // the same attitude as (-0.1, 0.2)
  CHECK(beyond.roll == doctest::Approx(-0.1));
  CHECK(beyond.pitch == doctest::Approx(0.2));
  CHECK_FALSE(gate.level({0.0, 7.0, 0.0}));
  CHECK(gate.mounting().kind == Kind::Level);
}

TEST_CASE("a steep slope is no mounting, and an attitude of no robot is not used") {
  AttitudeGate gate;
  for (int i = 0; i < 20; ++i) {
    CHECK(gate.level({0.1 * i, 0.0, i % 3 == 1 ? -0.9 : -0.3}));
  }
  CHECK_FALSE(gate.level({3.0, kPi, 0.0}));
  CHECK(gate.mounting().kind == Kind::Level);
}

}  // namespace
}  // namespace slipwise
