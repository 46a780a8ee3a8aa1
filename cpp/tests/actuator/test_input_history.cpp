// SPDX-License-Identifier: Apache-2.0
// Sample-and-hold inputs.
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "slipwise/actuator/input_history.hpp"

namespace slipwise {
namespace {

using Values = std::vector<double>;

const InputHistory kTrack(Values{1.0, 2.0, 4.0}, Values{0.1, 0.2, 0.3}, Values{0.0, 0.0, 0.5},
                          Values{-1.0, -2.0, -3.0});

TEST_CASE("a sample is held until the next one") {
  CHECK(kTrack.at(1.0).v == 0.1);
  CHECK(kTrack.at(1.999).omega == -1.0);
  CHECK(kTrack.at(2.0).v == 0.2);
  CHECK(kTrack.at(100.0).vy == 0.5);
}

TEST_CASE("the robot is at rest before the first sample") {
  CHECK(kTrack.at(0.999).v == 0.0);
  CHECK(kTrack.count_until(0.999) == 0);
  CHECK(kTrack.count_until(1.0) == 1);
  CHECK(kTrack.count_until(9.0) == 3);
}

TEST_CASE("inputs of unequal lengths are refused with the lengths") {
  CHECK_THROWS_WITH_AS(InputHistory(Values{1.0, 2.0}, Values{0.0}, Values{0.0, 0.0}, Values{0.0, 0.0}),
                       doctest::Contains("got 2, 1, 2, 2"), std::invalid_argument);
}

TEST_CASE("times that do not increase are refused with the place") {
  const Values zeros{0.0, 0.0};
  CHECK_THROWS_WITH_AS(InputHistory(Values{1.0, 1.0}, zeros, zeros, zeros), doctest::Contains("input 1"),
                       std::invalid_argument);
}

TEST_CASE("values that are not finite are refused with the place") {
  const Values zeros{0.0, 0.0};
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_WITH_AS(InputHistory(Values{1.0, 2.0}, Values{0.0, bad}, zeros, zeros), doctest::Contains("input 1"),
                         std::invalid_argument);
    CHECK_THROWS_AS(InputHistory(Values{bad, 2.0}, zeros, zeros, zeros), std::invalid_argument);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(InputHistory(Values{1.0}, Values{infinity}, Values{-infinity}, Values{0.0}), std::invalid_argument);
}

TEST_CASE("values near the end of the number range are kept") {
  const InputHistory history(Values{1.0}, Values{1e308}, Values{1e308}, Values{0.0});
  CHECK(history.at(1.0).v == 1e308);
}

}  // namespace
}  // namespace slipwise
