// SPDX-License-Identifier: Apache-2.0
// The law of a trailer: straight it follows, in a circle it settles, backwards it folds.
#include "slipwise/vehicle/trailer.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "finite_difference.hpp"

namespace slipwise {
namespace {

constexpr Trailer kTrailer{.length = 1.5, .hitch_offset = 0.4};

TEST_CASE("a trailer that is pulled straight dies away with its length over the speed") {
  const HitchStep step = hitch_after(kTrailer, 0.1, {.v = 1.0}, 1.5);
  CHECK(std::tan(step.psi / 2.0) == doctest::Approx(std::tan(0.05) * std::exp(-1.0)));  // exact for a tractrix
}

TEST_CASE("in a steady circle the angle is that of the two radii") {
  const BodyTwist twist{.v = 1.0, .vy = 0.0, .omega = 0.25};
  const double psi = hitch_after(kTrailer, 0.0, twist, 60.0).psi;
  CHECK(hitch_rate(kTrailer, psi, twist) == doctest::Approx(0.0).epsilon(1e-9));
  const double hitch_radius = std::hypot(4.0, kTrailer.hitch_offset);
  const double axle_radius = std::sqrt(hitch_radius * hitch_radius - kTrailer.length * kTrailer.length);
  const Pose2 vehicle{0.0, 0.0, 0.0};
  const Pose2 axle = trailer_pose(kTrailer, vehicle, psi);
  CHECK(std::hypot(axle.x, axle.y - 4.0) == doctest::Approx(axle_radius).epsilon(1e-6));
}

TEST_CASE("backwards a small angle grows") { CHECK(hitch_after(kTrailer, 0.05, {.v = -1.0}, 1.5).psi > 0.12); }

TEST_CASE("left mirrors right") {
  const double left = hitch_after(kTrailer, 0.2, {.v = 0.8, .vy = 0.1, .omega = 0.5}, 2.0).psi;
  const double right = hitch_after(kTrailer, -0.2, {.v = 0.8, .vy = -0.1, .omega = -0.5}, 2.0).psi;
  CHECK(left == doctest::Approx(-right));
}

TEST_CASE("the trailer's axle does not slide across") {
  const BodyTwist twist{.v = 0.7, .vy = 0.05, .omega = -0.4};
  constexpr double kTime = 1e-4;
  const double psi = 0.3;
  const Pose2 before = trailer_pose(kTrailer, {}, psi);
  const Pose2 vehicle = exp(kTime * Eigen::Vector3d(twist.v, twist.vy, twist.omega));
  const Pose2 after = trailer_pose(kTrailer, vehicle, hitch_after(kTrailer, psi, twist, kTime).psi);
  CHECK(std::abs(between(before, after).y) < 1e-8);
}

TEST_CASE("derivatives by angle, length and offset equal finite differences") {
  for (const BodyTwist& twist : {BodyTwist{.v = 0.9, .vy = 0.0, .omega = 0.4}, {.v = -0.5, .vy = 0.2, .omega = -0.3}}) {
    const auto value = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      return Eigen::VectorXd::Constant(1,
                                       hitch_after({.length = at[1], .hitch_offset = at[2]}, at[0], twist, 0.73).psi);
    };
    const Eigen::Vector3d at(0.4, 1.5, 0.4);
    const Eigen::RowVector3d analytic = hitch_after(kTrailer, 0.4, twist, 0.73).by;
    CHECK(tests::jacobian_error(analytic, tests::finite_difference(value, at, 0.01)) < tests::kDerivativeTolerance);
  }
}

TEST_CASE("a trailer without length is refused") {
  CHECK_THROWS_AS(hitch_after({.length = 0.0, .hitch_offset = 0.0}, 0.0, {.v = 1.0}, 1.0), std::invalid_argument);
  CHECK_THROWS_AS(hitch_after(kTrailer, 0.0, {.v = 1.0}, -1.0), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
