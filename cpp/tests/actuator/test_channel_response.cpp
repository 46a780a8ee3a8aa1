// SPDX-License-Identifier: Apache-2.0
// How a channel shares its input between its lags, and for how long its past matters.
#include <doctest/doctest.h>

#include "slipwise/actuator/channel_response.hpp"

namespace slipwise {
namespace {

constexpr CommandChain kChain{.lag_v = 0.2,
                              .lag_omega = 0.1,
                              .gain_v = 0.9,
                              .gain_omega = 1.2,
                              .slow_share_v = 0.25,
                              .slow_share_omega = 0.4,
                              .slow_lag_v = 1.5};

TEST_CASE("speed and yaw rate take their own numbers of the chain") {
  CHECK(speed_response(kChain).gain == 0.9);
  CHECK(speed_response(kChain).longest_lag() == 1.5);
  CHECK(turn_response(kChain).gain == 1.2);
  CHECK(turn_response(kChain).longest_lag() == 0.1);
}

TEST_CASE("a slow share without a slow time constant has no effect") {
  CHECK_FALSE(turn_response(kChain).has_slow_part());
  CHECK(turn_response(kChain).share() == 0.0);
  CHECK(turn_response(kChain).fast_share() == 1.2);
  CHECK(speed_response(kChain).fast_share() == doctest::Approx(0.75 * 0.9));
}

TEST_CASE("the input that keeps a channel is its drive over the gain, and none keeps a dead one") {
  CHECK(speed_response(kChain).keeping_input(0.45) == doctest::Approx(0.5));
  CHECK(ChannelResponse{.gain = 0.0, .lag = 0.1, .slow_share = 0.0, .slow_lag = 0.0}.keeping_input(0.4) == 0.0);
}

TEST_CASE("only channels with a slow part need their inputs followed before the drive is known") {
  CHECK(parts_warm_up(speed_response(kChain), turn_response(kChain)) == doctest::Approx(8.0 * 1.5));
  CHECK(parts_warm_up(turn_response(kChain), turn_response(kChain)) == 0.0);
}

}  // namespace
}  // namespace slipwise
