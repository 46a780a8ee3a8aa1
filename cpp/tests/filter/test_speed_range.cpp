// SPDX-License-Identifier: Apache-2.0
// The causal quantile of speeds.
#include <doctest/doctest.h>

#include "slipwise/filter/speed_range.hpp"

namespace slipwise {
namespace {

TEST_CASE("before anything moved the quantile is the floor") {
  const SpeedRange range;
  CHECK(range.quantile(0.9, 0.05) == 0.05);
}

TEST_CASE("standstill does not count") {
  SpeedRange range;
  range.add(0.0, 1000.0);
  range.add(2.0, 1.0);
  CHECK(range.quantile(0.9, 0.05) == doctest::Approx(2.0).epsilon(0.05));
}

TEST_CASE("the quantile is weighted by time and blind to the sign") {
  SpeedRange range;
  range.add(-1.0, 80.0);
  range.add(3.0, 20.0);
  CHECK(range.quantile(0.75, 0.05) == doctest::Approx(1.0).epsilon(0.05));
  CHECK(range.quantile(0.9, 0.05) == doctest::Approx(3.0).epsilon(0.05));
}

TEST_CASE("speeds beyond the histogram fall into its last bin") {
  SpeedRange range;
  range.add(1e9, 1.0);
  CHECK(range.quantile(0.9, 0.05) > 900.0);
}

}  // namespace
}  // namespace slipwise
