// SPDX-License-Identifier: Apache-2.0
// What a channel's lags hold where a rollout starts, from the commands before it.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <type_traits>

#include "slipwise/rollout/actuator_start.hpp"

namespace slipwise {
namespace {

constexpr double kPeriod = 0.1;

ActuatorSchedule schedule(double slow_time_constant) {
  return schedule_actuator({.time_constant_v = 0.2,
                            .delay_v = 0.25,
                            .gain_v = 0.8,
                            .slow_fraction_v = 0.3,
                            .slow_time_constant_v = slow_time_constant},
                           kPeriod);
}

TEST_CASE("without a slow mode all of the drive is the fast lag's") {
  const ActuatorSchedule actuator = schedule(0.0);
  const ActuatorStart start = actuator_start(actuator, actuator.v, 0.7, -3, [](std::ptrdiff_t) { return 9.0; });
  CHECK(start.fast == 0.7);
  CHECK(start.slow == 0.0);
}

TEST_CASE("a drive that no command reaches before its start is settled: its lags share it as they share the input") {
  const ActuatorSchedule actuator = schedule(2.0);
  const ActuatorStart start = actuator_start(actuator, actuator.v, 0.6, 0, [](std::ptrdiff_t) { return 9.0; });
  CHECK(start.commanded == doctest::Approx(0.75));
  CHECK(start.fast == doctest::Approx(0.7 * 0.6));
  CHECK(start.slow == doctest::Approx(0.3 * 0.6));
}

TEST_CASE("a command that was held for long gives the same parts, where the drive is what it leads to") {
  const ActuatorSchedule actuator = schedule(2.0);
  const ActuatorStart start = actuator_start(actuator, actuator.v, 0.6, -400, [](std::ptrdiff_t) { return 0.75; });
  CHECK(start.fast == doctest::Approx(0.7 * 0.6));
  CHECK(start.slow == doctest::Approx(0.3 * 0.6));
}

TEST_CASE("whatever was commanded, the parts make up the drive that was measured") {
  const ActuatorSchedule actuator = schedule(2.0);
  for (const double drive : {-0.4, 0.0, 0.5, 1.5}) {
    const auto command = [](std::ptrdiff_t i) { return i % 7 == 0 ? -0.5 : 0.1 * static_cast<double>(i % 5); };
    const ActuatorStart start = actuator_start(actuator, actuator.v, drive, -40, command);
    CHECK(start.fast + start.slow == doctest::Approx(drive));
  }
}

TEST_CASE("a command moves a lag once its delay is over, and not before") {
  const ActuatorSchedule actuator = schedule(2.0);
  const auto inputs_of = [&](const auto& command) {
    return StartInputs<std::decay_t<decltype(command)>>{actuator.v, kPeriod, -40, 0.0, command};
  };
  // Command -5, sent 0.5 s before the start, is the first to differ; it acts 0.25 s before the start.
  const auto acting = [](std::ptrdiff_t i) { return i >= -5 ? 1.0 : 0.0; };
  CHECK(acts_at(actuator.v, kPeriod, -5) == doctest::Approx(-0.25));
  CHECK(inputs_of(acting).lagged(0.2, 1.6) == doctest::Approx(1.0 - std::exp(-0.25 / 0.2)));
  CHECK(inputs_of(acting).now() == 1.0);
  const auto coming = [](std::ptrdiff_t i) { return i >= -2 ? 100.0 : 1.0; };  // acts 0.05 s after the start
  CHECK(inputs_of(coming).lagged(0.2, 1.6) == doctest::Approx(1.0));
  CHECK(inputs_of(coming).now() == 1.0);
}

}  // namespace
}  // namespace slipwise
