// SPDX-License-Identifier: Apache-2.0
// How a channel shares its input between its lags, and for how long its past matters.
#include <doctest/doctest.h>

#include "slipwise/actuator/axis_response.hpp"

namespace slipwise {
namespace {

constexpr ActuatorModel kActuator{.time_constant_v = 0.2,
                                  .time_constant_omega = 0.1,
                                  .gain_v = 0.9,
                                  .gain_omega = 1.2,
                                  .slow_fraction_v = 0.25,
                                  .slow_fraction_omega = 0.4,
                                  .slow_time_constant_v = 1.5};

TEST_CASE("speed and yaw rate take their own numbers of the actuator") {
  CHECK(speed_response(kActuator).gain == 0.9);
  CHECK(speed_response(kActuator).longest_lag() == 1.5);
  CHECK(yaw_rate_response(kActuator).gain == 1.2);
  CHECK(yaw_rate_response(kActuator).longest_lag() == 0.1);
}

TEST_CASE("a slow fraction without a slow time constant has no effect") {
  CHECK_FALSE(yaw_rate_response(kActuator).has_slow_mode());
  CHECK(yaw_rate_response(kActuator).fraction() == 0.0);
  CHECK(yaw_rate_response(kActuator).fast_fraction() == 1.2);
  CHECK(speed_response(kActuator).fast_fraction() == doctest::Approx(0.75 * 0.9));
}

TEST_CASE("the input that keeps a channel is its drive over the gain, and none keeps a dead one") {
  CHECK(speed_response(kActuator).keeping_input(0.45) == doctest::Approx(0.5));
  CHECK(AxisResponse{.gain = 0.0, .time_constant = 0.1, .slow_fraction = 0.0, .slow_time_constant = 0.0}.keeping_input(
            0.4) == 0.0);
}

TEST_CASE("only channels with a slow mode need their inputs followed before the drive is known") {
  CHECK(parts_warm_up(speed_response(kActuator), yaw_rate_response(kActuator)) == doctest::Approx(8.0 * 1.5));
  CHECK(parts_warm_up(yaw_rate_response(kActuator), yaw_rate_response(kActuator)) == 0.0);
}

}  // namespace
}  // namespace slipwise
