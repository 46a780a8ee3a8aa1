// SPDX-License-Identifier: Apache-2.0
// Known forces at a stamp, and on the whole over a segment.
#include <doctest/doctest.h>

#include "slipwise/linear/present.hpp"
#include "slipwise/online/force_buffer.hpp"

namespace slipwise {

TEST_CASE("a known force holds until the next one, and a segment has the mean of all over it") {
  ForceBuffer forces;
  CHECK(!forces.at(1.0));
  CHECK(!forces.mean(0.0, 1.0));
  forces.push({1.0, 2.0, 0.0});
  forces.push({2.0, -2.0, 1.0});
  CHECK(!forces.at(0.5));
  CHECK(present(forces.at(1.5)).x == 2.0);
  CHECK(present(forces.at(9.0)).y == 1.0);
  const KnownForce mean = present(forces.mean(0.0, 4.0));  // 1 s without, 1 s of the first, 2 s of the second
  CHECK(mean.x == doctest::Approx((2.0 - 4.0) / 4.0));
  CHECK(mean.y == doctest::Approx(2.0 / 4.0));
  CHECK(!forces.mean(0.0, 1.0));
  forces.drop_before(3.0);
  CHECK(!forces.at(1.5));
  CHECK(present(forces.at(2.5)).x == -2.0);
}

}  // namespace slipwise
