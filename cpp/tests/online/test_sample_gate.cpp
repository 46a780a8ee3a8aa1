// SPDX-License-Identifier: Apache-2.0
// What is no measurement is rejected with its reason; what a robot can do is not.
#include <doctest/doctest.h>

#include <array>
#include <limits>

#include "slipwise/online/sample_gate.hpp"

namespace slipwise {

TEST_CASE("stamps must go forward, and be times; numbers must be numbers") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, 2> fine{1.0, -2.0};
  const std::array<double, 2> broken{1.0, kNaN};
  const std::array<double, 2> huge{1.0, -1e31};
  StampGate gate;
  CHECK(!gate.check(10.0, fine));
  CHECK(gate.check(10.0, fine) == Reason::DuplicateStamp);
  CHECK(gate.check(9.0, fine) == Reason::BackwardStamp);
  CHECK(gate.check(11.0, broken) == Reason::NotFinite);
  CHECK(gate.check(11.0, huge) == Reason::NotFinite);
  CHECK(gate.check(kNaN, fine) == Reason::NotFinite);
  CHECK(gate.check(1.7e18, fine) == Reason::ImpossibleStamp);  // nanoseconds
  CHECK(gate.latest() == 10.0);                                // nothing rejected moves it
  CHECK(!gate.check(11.0, fine));
  CHECK(gate.latest() == 11.0);
}

TEST_CASE("a speed that no robot has is not believed alone, and above 100 not at all") {
  SpeedGate gate;
  CHECK(gate.plausible(-19.0));
  CHECK(!gate.plausible(1e4));
  CHECK(!gate.plausible(1e4));
  SpeedGate slow;
  CHECK(slow.plausible(1.0));
  CHECK(!slow.plausible(60.0));  // a spike
  CHECK(slow.plausible(1.0));
  CHECK(!slow.plausible(60.0));
  CHECK(slow.plausible(62.0));   // not one: it comes twice in a row
  CHECK(slow.plausible(300.0));  // within fifteen times what was believed
}

TEST_CASE("a spike of wheels goes by what the stream holds, not by what robots can drive") {
  SpeedGate turning;
  CHECK(turning.plausible(17.9, true));  // nothing is known at the first, and it says nothing of the next
  for (const double rate : {0.0, 0.3, 0.9, -0.9}) {
    CHECK(turning.plausible(rate, true));
    CHECK(!turning.plausible(18.5, true));
    CHECK(turning.plausible(rate, true));
  }
  CHECK(turning.plausible(4.9, true));
  SpeedGate commanded;
  CHECK(commanded.plausible(0.0));
  CHECK(commanded.plausible(18.5));  // a command may step
}

}  // namespace slipwise
