// SPDX-License-Identifier: Apache-2.0
// The commands of an axis, each once, and the speeds and rates that its wheels reached.
#include "slipwise/identify/axis_range.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace slipwise {
namespace {

const CommandLimits kUnlimited{.wheel_separation = 1.0};

/// Wheels at 10 Hz that gain 1 m/s^2, behind commands of both signs.
WheelRecord record() {
  const InputHistory commands({0.0, 1.0, 2.0, 3.0}, {{.v = 0.5, .vy = 0.0, .omega = 0.2},
                                                     {.v = -0.5, .vy = 0.0, .omega = 0.2},
                                                     {.v = 0.0, .vy = 0.0, .omega = 1e-12},
                                                     {.v = 0.3, .vy = 0.0, .omega = 0.0}});
  std::vector<double> t;
  std::vector<BodyTwist> wheels;
  for (int i = 0; i <= 10; ++i) {
    t.push_back(0.1 * i);
    wheels.push_back({.v = 0.1 * i, .vy = 0.0, .omega = 0.0});
  }
  return {commands, t, wheels};
}

std::vector<double> command_speeds(const AxisRange& range) {
  std::vector<double> speeds;
  std::ranges::transform(range.commands, std::back_inserter(speeds), &Asked::speed);
  return speeds;
}

TEST_CASE("commands of one size count once whatever their sign, and what rounding leaves of zero does not") {
  const std::vector<WheelRecord> records{record()};
  CHECK(command_speeds(axis_range(records, kUnlimited, LimitedAxis::Speed)) == std::vector<double>{0.3, 0.5});
  CHECK(command_speeds(axis_range(records, kUnlimited, LimitedAxis::YawRate)) == std::vector<double>{0.2});
  CHECK(axis_range(records, kUnlimited, LimitedAxis::Speed).step == doctest::Approx(1.0));  // from 0.5 to -0.5
}

TEST_CASE("rates of wheels are means over a fifth of a second") {
  const std::vector<WheelRecord> records{record()};
  const AxisRange range = axis_range(records, kUnlimited, LimitedAxis::Speed);
  CHECK(range.speeds.front() == 0.0);
  CHECK(range.speeds.back() == doctest::Approx(1.0));
  REQUIRE(range.rates.size() == 2 * 5);  // both signs of an axis have the same
  CHECK(range.rates.front() == doctest::Approx(1.0));
  CHECK(range.rates.back() == doctest::Approx(1.0));
}

TEST_CASE("each side has a speed of its own, behind the limits of the channels") {
  const std::vector<WheelRecord> records{record()};
  const AxisRange sides = axis_range(records, kUnlimited, LimitedAxis::Side);
  CHECK(sides.commands.back().speed == doctest::Approx(0.6));  // 0.5 m/s and half of 0.2 rad/s over 1 m
  CHECK(speed_of_side(kUnlimited, sides.commands.back().of_side) == doctest::Approx(0.6));
  CommandLimits slow = kUnlimited;
  slow.speed.saturation = 0.4;
  CHECK(axis_range(records, slow, LimitedAxis::Side).commands.back().speed == doctest::Approx(0.5));
  CHECK(axis_range(records, slow, LimitedAxis::Speed).commands.back().speed == doctest::Approx(0.5));
}

}  // namespace
}  // namespace slipwise
