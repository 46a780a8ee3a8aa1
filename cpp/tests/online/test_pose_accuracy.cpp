// SPDX-License-Identifier: Apache-2.0
// What a sensor says of its accuracy counts beside what it said before.
#include <doctest/doctest.h>

#include <limits>

#include "slipwise/online/pose_accuracy.hpp"

namespace slipwise {

TEST_CASE("a standard deviation that never changes says nothing, whatever it is") {
  for (const double std : {1e-6, 0.02, 99999.0}) {
    NominalStd nominal;
    for (int i = 0; i < 100; ++i) {
      CHECK(nominal.ratio(std) == doctest::Approx(1.0));
    }
  }
}

TEST_CASE("poses without one count as nominal and teach nothing") {
  NominalStd nominal;
  CHECK(nominal.ratio(0.0) == 1.0);
  CHECK(nominal.ratio(0.02) == 1.0);
  CHECK(nominal.ratio(0.0) == 1.0);
  CHECK(nominal.ratio(std::numeric_limits<double>::quiet_NaN()) == 1.0);
  CHECK(nominal.ratio(0.04) == doctest::Approx(2.0));
}

TEST_CASE("a poor pose among good ones counts for less, and hardly changes what is nominal") {
  NominalStd nominal;
  for (int i = 0; i < 1000; ++i) {
    nominal.ratio(0.02);
  }
  CHECK(nominal.ratio(0.5) == doctest::Approx(25.0));
  CHECK(nominal.ratio(0.02) == doctest::Approx(1.0).epsilon(0.01));
  CHECK(nominal.ratio(1e30) == doctest::Approx(1e3));
}

TEST_CASE("what lasts becomes nominal") {
  NominalStd nominal;
  nominal.ratio(0.02);
  double last = 0.0;
  for (int i = 0; i < 10000; ++i) {
    last = nominal.ratio(0.5);
  }
  CHECK(last == doctest::Approx(1.0).epsilon(0.01));
}

TEST_CASE("position and heading have each their own") {
  PoseAccuracy accuracy;
  accuracy.ratio({.xy = 0.02, .yaw = 0.01});
  const PoseStdRatio ratio = accuracy.ratio({.xy = 0.02, .yaw = 0.03});
  CHECK(ratio.xy == doctest::Approx(1.0));
  CHECK(ratio.yaw == doctest::Approx(3.0));
}

}  // namespace slipwise
