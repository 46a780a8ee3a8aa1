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

/// The last of a hundred attitudes of a robot on waves, as a sensor sees them that is turned about its forward axis.
Tilt last_of(AttitudeGate& gate, double mounted) {
  Tilt last{};
  for (int i = 0; i < 100; ++i) {
    last = present(gate.level({0.1 * i, 0.1 * std::sin(0.3 * i) + mounted, 0.2 * std::cos(0.2 * i)}));
  }
  return last;
}

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

TEST_CASE("a sensor on its side or upside down shows the robot's own tilt") {
  AttitudeGate level;
  const Tilt robot = last_of(level, 0.0);
  for (const double mounted : {0.5 * kPi, -0.5 * kPi, kPi}) {
    AttitudeGate gate;
    const Tilt seen = last_of(gate, mounted);
    CHECK(seen.roll == doctest::Approx(robot.roll));
    CHECK(seen.pitch == robot.pitch);
    CHECK(gate.mounting().kind == Kind::Rolled);
    CHECK(std::abs(wrap_angle(gate.mounting().roll - mounted)) < 1e-9);
  }
}

TEST_CASE("of a sensor that looks up, or sits askew, no tilt is used") {
  for (const auto& [roll, pitch] : {std::pair{0.0, -1.5}, std::pair{1.0, 0.1}}) {
    AttitudeGate gate;
    for (int i = 0; i < 10; ++i) {
      CHECK_FALSE(gate.level({0.1 * i, roll, pitch}));
    }
    CHECK(gate.mounting().kind == Kind::Other);
    CHECK(gate.mounting().pitch == doctest::Approx(pitch));
  }
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
