// SPDX-License-Identifier: Apache-2.0
// How a control period is cut: parts add up, commands begin to act where their delay says, lags close as they do.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <vector>

#include "slipwise/rollout/actuator_schedule.hpp"

namespace slipwise {
namespace {

double total(const std::vector<PeriodPart>& parts) {
  double sum = 0.0;
  for (const PeriodPart& part : parts) {
    sum += part.duration;
  }
  return sum;
}

/// From the start of the cycle to the part in which a channel's next command begins to act.
double begins(const std::vector<PeriodPart>& parts, bool PeriodPart::* next) {
  double t = 0.0;
  for (const PeriodPart& part : parts) {
    if (part.*next) {
      return t;
    }
    t += part.duration;
  }
  return std::numeric_limits<double>::infinity();
}

TEST_CASE("without delay and lag a period is one part in which both commands act") {
  const ActuatorSchedule schedule = schedule_actuator({}, 0.1);
  REQUIRE(schedule.cycle.size() == 1);
  CHECK(schedule.cycle[0].next_v);
  CHECK(schedule.cycle[0].next_omega);
  CHECK(schedule.cycle[0].duration == doctest::Approx(0.1));
  CHECK(schedule.lead_in.empty());
  CHECK(schedule.tail.empty());
  CHECK_FALSE(schedule.lags);
  CHECK_FALSE(schedule.responds);
}

TEST_CASE("delays are whole periods and a rest, and a cycle is one period long") {
  for (const double period : {0.05, 0.1, 0.25}) {
    const ActuatorModel actuator{.time_constant_v = 0.2, .delay_v = 0.13, .delay_omega = 0.36, .clock_offset = -0.02};
    const ActuatorSchedule schedule = schedule_actuator(actuator, period);
    CHECK(static_cast<double>(schedule.v.shift) * period + schedule.v.rest == doctest::Approx(0.11));
    CHECK(static_cast<double>(schedule.omega.shift) * period + schedule.omega.rest == doctest::Approx(0.34));
    CHECK(total(schedule.cycle) == doctest::Approx(period));
    CHECK(total(schedule.lead_in) + begins(schedule.cycle, &PeriodPart::next_v) == doctest::Approx(schedule.v.rest));
    CHECK(total(schedule.lead_in) + begins(schedule.cycle, &PeriodPart::next_omega) ==
          doctest::Approx(schedule.omega.rest));
    const std::vector<PeriodPart> before(schedule.cycle.begin(),
                                         schedule.cycle.begin() + static_cast<std::ptrdiff_t>(schedule.branch));
    CHECK(total(schedule.lead_in) + total(before) + total(schedule.tail) == doctest::Approx(period));
  }
}

TEST_CASE("poses that are stamped too early make commands act before they are sent") {
  const ActuatorSchedule schedule = schedule_actuator({.clock_offset = -0.07}, 0.1);
  CHECK(schedule.v.shift == -1);
  CHECK(schedule.v.rest == doctest::Approx(0.03));
}

TEST_CASE("a delay that is whole periods but for rounding has no rest") {
  const ActuatorSchedule schedule = schedule_actuator({.delay_v = 3.0 * 0.1, .delay_omega = 0.3 - 1e-14}, 0.1);
  CHECK(schedule.v.shift == 3);
  CHECK(schedule.omega.shift == 3);
  CHECK(schedule.v.rest == 0.0);
  CHECK(schedule.omega.rest == 0.0);
}

TEST_CASE("over a part a gap closes by the exponential of its lag, and lagging parts are short") {
  const ActuatorSchedule schedule =
      schedule_actuator({.time_constant_v = 0.3, .slow_fraction_v = 0.2, .slow_time_constant_v = 2.0}, 0.45);
  CHECK(schedule.cycle.size() > 4);
  CHECK(schedule.lags);
  CHECK(schedule.responds);
  for (const PeriodPart& part : schedule.cycle) {
    CHECK(part.v.fast.end_gap == doctest::Approx(std::exp(-part.duration / 0.3)));
    CHECK(part.v.slow.mean_gap == doctest::Approx(2.0 / part.duration * (1.0 - std::exp(-part.duration / 2.0))));
    CHECK(part.omega.fast.end_gap == 0.0);
    CHECK(part.omega.fast.mean_gap == 0.0);
  }
}

TEST_CASE("a period that is no positive time, or far shorter than the delay, is refused") {
  for (const double wrong : {0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_AS(schedule_actuator({}, wrong), std::invalid_argument);
  }
  CHECK_THROWS_AS(schedule_actuator({.delay_v = 2.0}, 1e-6), std::invalid_argument);
  CHECK_NOTHROW(schedule_actuator({.delay_v = 2.0}, 1e-5));
}

}  // namespace
}  // namespace slipwise
