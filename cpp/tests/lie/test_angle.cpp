// SPDX-License-Identifier: Apache-2.0
// Wrapping to one turn.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "slipwise/lie/angle.hpp"

namespace slipwise {
namespace {

constexpr double kPi = std::numbers::pi;

TEST_CASE("a wrapped angle lies in (-pi, pi] and points the same way") {
  for (const double angle : {0.0, 1.0, -1.0, 3.2, -3.2, 7.0, 100.0, -100.0}) {
    CAPTURE(angle);
    const double wrapped = wrap_angle(angle);
    CHECK(wrapped > -kPi);
    CHECK(wrapped <= kPi);
    CHECK(std::sin(wrapped) == doctest::Approx(std::sin(angle)).epsilon(1e-12));
    CHECK(std::cos(wrapped) == doctest::Approx(std::cos(angle)).epsilon(1e-12));
  }
}

TEST_CASE("half a turn to either side wraps to plus pi") {
  CHECK(wrap_angle(kPi) == kPi);
  CHECK(wrap_angle(-kPi) == kPi);
}

}  // namespace
}  // namespace slipwise
