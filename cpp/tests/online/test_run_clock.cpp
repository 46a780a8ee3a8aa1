// SPDX-License-Identifier: Apache-2.0
// Stamps go in and come out as they were.
#include <doctest/doctest.h>

#include <initializer_list>

#include "slipwise/online/run_clock.hpp"

namespace slipwise {
namespace {

TEST_CASE("stamps are counted from the day of the first, and come back to the bit") {
  RunClock clock;
  clock.start_at(1.7e9 + 0.3);
  for (const double stamp : {1.7e9 + 0.3, 1.7e9 + 0.1, 1.7e9 + 1234.56789, 1.7e9 + 1e7 / 3.0}) {
    CHECK(clock.stamp(clock.counted(stamp)) == stamp);
  }
  CHECK(clock.counted(1.7e9) >= 0.0);
  CHECK(clock.counted(1.7e9) < 86400.0);
  CHECK(clock.counted(1.7e9 + 2.5) - clock.counted(1.7e9) == 2.5);
}

TEST_CASE("what begins at zero is counted as it is") {
  RunClock clock;
  clock.start_at(0.05);
  CHECK(clock.counted(0.05) == 0.05);
  clock.start_at(-12.053);
  CHECK(clock.stamp(clock.counted(0.001)) == 0.001);
}

}  // namespace
}  // namespace slipwise
