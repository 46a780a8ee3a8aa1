// SPDX-License-Identifier: Apache-2.0
// The normalised innovation squared and the solution are those of the inverse.
#include "slipwise/linear/innovation.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

namespace slipwise {
namespace {

TEST_CASE("normalised square and solution agree with the inverse") {
  Eigen::Matrix3d s;
  s << 2.0, 0.3, -0.1, 0.3, 1.0, 0.2, -0.1, 0.2, 0.5;
  const Eigen::Vector3d r(0.4, -1.0, 2.0);
  Eigen::Matrix3Xd hp(3, 4);
  hp << 1.0, 2.0, 3.0, 4.0, -1.0, 0.5, 0.0, 2.0, 0.1, 0.2, 0.3, 0.4;
  CHECK(normalised_square(r, s) == doctest::Approx(r.dot(s.inverse() * r)));
  CHECK((solve_innovation(s, hp) - s.inverse() * hp).norm() < 1e-13);
}

}  // namespace
}  // namespace slipwise
