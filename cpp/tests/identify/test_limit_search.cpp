// SPDX-License-Identifier: Apache-2.0
// Limits are found where wheel speeds show them, left alone where not, and found again from what was found before.
#include "slipwise/identify/limit_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "limited_records.hpp"

namespace slipwise {
namespace {

using tests::kLimitedSeparation;
using tests::limited_record;

const CommandLimits kFree{.wheel_separation = kLimitedSeparation};
const CommandLimits kSides{.side = {.dead_band = 0.12, .saturation = 1.5, .slew_rate_up = 1.2, .slew_rate_down = 2.0},
                           .wheel_separation = kLimitedSeparation};
const CommandLimits kSpeed{.speed = {.saturation = 1.2}, .wheel_separation = kLimitedSeparation};

LimitSearch search(const CommandLimits& limits, unsigned seed, const std::optional<LimitedActuator>& before = {}) {
  const std::vector<WheelRecord> records{limited_record(limits, seed)};
  return find_limits(records, {}, 1.0, {}, before);
}

const FoundLimit* found(const LimitSearch& search, LimitedAxis axis, LimitKind kind) {
  const auto at = std::ranges::find_if(
      search.found, [&](const FoundLimit& limit) { return limit.axis == axis && limit.kind == kind; });
  return at == search.found.end() ? nullptr : &*at;
}

TEST_CASE("limits of the sides are found within three standard deviations, and no others") {
  const LimitSearch result = search(kSides, 11);
  for (const LimitKind kind : {LimitKind::Saturation, LimitKind::SlewRateUp, LimitKind::SlewRateDown}) {
    const FoundLimit* limit = found(result, LimitedAxis::Side, kind);
    REQUIRE(limit != nullptr);
    CHECK(std::abs(limit->value - limit_of(kSides.side, kind)) <= 3.0 * limit->std);
    CHECK(limit->std < 0.2 * limit->value);
    CHECK(limit->gain > LimitSearchSettings{}.least_gain);
  }
  CHECK(std::ranges::all_of(result.found, [](const FoundLimit& limit) { return limit.axis == LimitedAxis::Side; }));
  CHECK(result.drive.limits.wheel_separation == doctest::Approx(kLimitedSeparation).epsilon(0.1));
  CHECK(result.wheel_separation_std > 0.0);
}

TEST_CASE("a limit of the commanded speed alone is found as one of the speed, and the history is not asked for") {
  const LimitSearch result = search(kSpeed, 12);
  REQUIRE(result.found.size() == 1);
  CHECK(found(result, LimitedAxis::Speed, LimitKind::Saturation) != nullptr);
  CHECK(result.found.front().value == doctest::Approx(1.2).epsilon(0.03));
  CHECK(result.wheel_separation_std == 0.0);
  CHECK(result.drive.limits.wheel_separation == 1.0);
  CHECK(result.drive.limits.gain_v == 1.0);
  CHECK(result.drive.actuator.gain_v == doctest::Approx(1.0).epsilon(0.05));
}

TEST_CASE("a drive without limits shows none, and its delay and lag are found") {
  const LimitSearch result = search(kFree, 13);
  CHECK(result.found.empty());
  CHECK(unlimited(result.drive.limits));
  CHECK(result.drive.actuator.time_constant_v + result.drive.actuator.delay_v == doctest::Approx(0.56).epsilon(0.15));
}

TEST_CASE("rates of the drive itself, behind its lag, are found as such, and not too quick") {
  for (const double lag : {0.1, 0.3, 0.6}) {
    CAPTURE(lag);
    const ActuatorModel chain{.time_constant_v = lag, .time_constant_omega = 0.2, .delay_v = 0.15, .delay_omega = 0.1};
    const std::vector<WheelRecord> records{tests::rated_record(chain, {.up = 0.5, .down = 0.8}, 17)};
    const LimitSearch result = find_limits(records, {}, 1.0, {});
    REQUIRE(result.found.size() == 3);
    for (const auto& [kind, truth] : {std::pair{LimitKind::SlewRateUp, 0.5}, std::pair{LimitKind::SlewRateDown, 0.8},
                                      std::pair{LimitKind::SlewRateLag, lag}}) {
      const FoundLimit* limit = found(result, LimitedAxis::Speed, kind);
      REQUIRE(limit != nullptr);
      CHECK(std::abs(limit->value - truth) <= 3.0 * limit->std);
      CHECK(limit->std < (kind == LimitKind::SlewRateLag ? 0.15 : 0.02) * truth);
    }
    CHECK(result.drive.limits.speed.slew_rate_lag == result.drive.actuator.time_constant_v);
    const LimitSearch again = find_limits(records, {}, 1.0, {}, result.drive);
    REQUIRE(again.found.size() == 3);
    CHECK(found(again, LimitedAxis::Speed, LimitKind::SlewRateLag)->value == doctest::Approx(lag).epsilon(0.1));
  }
}

TEST_CASE("rates of the commands, in front of the lag, stay so") {
  CommandLimits limits = kFree;
  limits.speed = {.slew_rate_up = 0.5, .slew_rate_down = 0.8};
  const LimitSearch result = search(limits, 18);
  REQUIRE(result.found.size() == 2);
  CHECK(result.drive.limits.speed.slew_rate_lag == 0.0);
  CHECK(result.drive.limits.speed.slew_rate_up == doctest::Approx(0.5).epsilon(0.02));
  CHECK(result.drive.limits.speed.slew_rate_down == doctest::Approx(0.8).epsilon(0.02));
}

TEST_CASE("what a search found is found again from there") {
  const LimitSearch first = search(kSides, 14);
  const LimitSearch again = search(kSides, 14, first.drive);
  REQUIRE(again.found.size() == first.found.size());
  for (const FoundLimit& limit : first.found) {
    const FoundLimit* same = found(again, limit.axis, limit.kind);
    REQUIRE(same != nullptr);
    CHECK(same->value == doctest::Approx(limit.value).epsilon(0.05));
  }
}

TEST_CASE("the reach says what was commanded, and rounding is no command") {
  WheelRecord record = limited_record(kFree, 15);
  std::vector<double> v, omega;
  for (std::size_t i = 0; i < record.commands.size(); ++i) {
    const BodyTwist twist = record.commands.sample(i);
    v.push_back(i == 40 ? 0.1 + 0.2 - 0.3 : std::copysign(std::max(std::abs(twist.v), 0.2), twist.v));
    omega.push_back(twist.omega);
  }
  record.commands = InputHistory(record.t, v, std::vector<double>(v.size(), 0.0), omega);
  const std::vector<WheelRecord> records{record};
  const AxisReach reach = find_limits(records, {}, 1.0, {}).reach.front();
  CHECK(reach.slowest >= 0.2);
  CHECK(reach.fastest ==
        doctest::Approx(std::abs(*std::ranges::max_element(v, {}, [](double x) { return std::abs(x); }))));
  CHECK(reach.step > reach.fastest);
}

TEST_CASE("too few wheel speeds are refused with their number") {
  const std::vector<WheelRecord> records{limited_record(kFree, 16, 0.5)};
  CHECK_THROWS_WITH_AS(find_limits(records, {}, 1.0, {}), doctest::Contains("at least 20 wheel twists, got 9"),
                       std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
