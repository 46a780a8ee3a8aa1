// SPDX-License-Identifier: Apache-2.0
// Stamps of any hour of any day.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

#include "slipwise/linear/same_stamp.hpp"

namespace slipwise {
namespace {

constexpr double kToday = 1.7e9;  // [s] since 1970

TEST_CASE("stamps that rounding alone tells apart are the same, at any hour") {
  const double next = std::nextafter(kToday, 2.0 * kToday);
  CHECK(next - kToday > 2e-7);
  CHECK(same_stamp(kToday, next));
  CHECK_FALSE(later(next, kToday));
  CHECK(same_stamp(kToday + 0.1 + 0.2, kToday + 0.3));
}

TEST_CASE("a clock of microseconds tells two of its ticks apart, wherever it stands") {
  for (const double t : {0.0, kToday}) {
    CHECK(same_stamp(t, t + 1e-6));
    CHECK(later(t + 2e-6, t));
    CHECK_FALSE(later(t, t + 2e-6));
  }
}

}  // namespace
}  // namespace slipwise
