// SPDX-License-Identifier: Apache-2.0
// The loss of a drive behind limits is least at the truth, refining goes there, and the spread is true.
#include "slipwise/identify/limited_actuator_fit.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "limited_records.hpp"

namespace slipwise {
namespace {

using tests::kLimitedChain;
using tests::kLimitedSeparation;
using tests::limited_record;

constexpr double kNoBound = std::numeric_limits<double>::infinity();
const CommandLimits kLimits{.speed = {.saturation = 1.2, .slew_rate_up = 1.0, .slew_rate_down = 1.8},
                            .wheel_separation = kLimitedSeparation};

LimitedActuator true_drive() { return {.limits = kLimits, .actuator = kLimitedChain}; }

std::vector<WheelRecord> records_of(unsigned seed) { return {limited_record(kLimits, seed)}; }

TEST_CASE("the truth explains the wheels better than a drive without limits, or with others") {
  const std::vector<WheelRecord> records = records_of(21);
  const LimitedActuatorFit fit(records, {}, kLimitedSeparation);
  const double least = fit.scored(true_drive()).loss.total;
  LimitedActuator other = true_drive();
  other.limits = {.wheel_separation = kLimitedSeparation};
  CHECK(fit.scored(other).loss.total > least + 100.0);
  for (const LimitKind kind : {LimitKind::Saturation, LimitKind::SlewRateUp, LimitKind::SlewRateDown}) {
    for (const double factor : {0.8, 1.25}) {
      other = true_drive();
      limit_of(other.limits.speed, kind) *= factor;
      CHECK(fit.scored(other).loss.total > least + 20.0);
    }
  }
  CHECK(fit.samples() == records.front().t.size() - 1);
}

TEST_CASE("a drive is scored alike whatever was asked before") {
  const std::vector<WheelRecord> records = records_of(22);
  const LimitedActuatorFit fit(records, {}, kLimitedSeparation);
  const double first = fit.scored(true_drive()).loss.total;
  LimitedActuator other = true_drive();
  other.limits.speed.saturation = 1.4;
  other.actuator.time_constant_omega = 0.5;
  fit.scored(other);
  CHECK(fit.scored(true_drive()).loss.total == first);
  CHECK(LimitedActuatorFit(records, {}, kLimitedSeparation).scored(other).loss.total == fit.scored(other).loss.total);
}

TEST_CASE("refining from elsewhere comes to the truth within three reported standard deviations") {
  const std::vector<WheelRecord> records = records_of(23);
  const LimitedActuatorFit fit(records, {}, kLimitedSeparation);
  LimitedActuator start = true_drive();
  start.limits.speed = {.saturation = 1.3, .slew_rate_up = 1.3, .slew_rate_down = 1.4};
  start.actuator.time_constant_v = 0.25;
  start.actuator.delay_omega = 0.15;
  const ScoredActuator refined = fit.refine(start, 40);
  CHECK(refined.loss.total <= fit.scored(true_drive()).loss.total);
  const LimitedActuatorFit::Spread spread = fit.spread(refined.drive);
  for (const LimitKind kind : {LimitKind::Saturation, LimitKind::SlewRateUp, LimitKind::SlewRateDown}) {
    const double std = spread.std.front().at(static_cast<std::size_t>(kind));
    CHECK(std > 0.0);
    CHECK(std < 0.2 * limit_of(kLimits.speed, kind));
    CHECK(std::abs(limit_of(refined.drive.limits.speed, kind) - limit_of(kLimits.speed, kind)) <= 3.0 * std);
  }
  CHECK(refined.drive.actuator.time_constant_v == doctest::Approx(kLimitedChain.time_constant_v).epsilon(0.15));
}

TEST_CASE("what limits nothing stays so, and has no spread") {
  const std::vector<WheelRecord> records = records_of(24);
  const LimitedActuatorFit fit(records, {}, kLimitedSeparation);
  const ScoredActuator refined = fit.refine(true_drive(), 10);
  CHECK(refined.drive.limits.yaw_rate == AxisLimits{});
  CHECK(refined.drive.limits.side == AxisLimits{});
  const LimitedActuatorFit::Spread spread = fit.spread(refined.drive);
  CHECK(spread.std.at(1) == std::array<double, kLimitKinds.size()>{});
  CHECK(spread.std.at(2) == std::array<double, kLimitKinds.size()>{});
  CHECK(spread.std.front().at(static_cast<std::size_t>(LimitKind::DeadBand)) == 0.0);
}

TEST_CASE("no step makes a drive worse, however few are taken") {
  const std::vector<WheelRecord> records = records_of(25);
  const LimitedActuatorFit fit(records, {}, kLimitedSeparation);
  double before = fit.scored(fit.start()).loss.total;
  for (const int steps : {1, 2, 5, 20}) {
    const double after = fit.refine(fit.start(), steps).loss.total;
    CHECK(after <= before);
    before = after;
  }
}

TEST_CASE("kinds and axes of limits are places in them") {
  AxisLimits axis;
  for (const LimitKind kind : kLimitKinds) {
    CHECK_FALSE(limits_anything(axis, kind));
    limit_of(axis, kind) = 0.7;
    CHECK(limits_anything(axis, kind));
  }
  CHECK(axis == AxisLimits{.dead_band = 0.7, .saturation = 0.7, .slew_rate_up = 0.7, .slew_rate_down = 0.7});
  CommandLimits limits;
  axis_of(limits, LimitedAxis::Side).saturation = 0.4;
  CHECK(limits.side.saturation == 0.4);
  CHECK(limits.speed.saturation == kNoBound);
  const CommandLimits sides{.wheel_separation = 2.0, .gain_v = 0.5, .gain_omega = 3.0};
  CHECK(speed_of_side(sides, {.v = 1.0, .omega = -0.1}) == doctest::Approx(0.2));
}

}  // namespace
}  // namespace slipwise
