// SPDX-License-Identifier: Apache-2.0
// Attitudes, planes, and how a robot stands on them.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "slipwise/segment/ground.hpp"

namespace slipwise {
namespace {

TEST_CASE("the plane under a tilted robot tilts it that way again") {
  const Tilt tilt{0.0, 0.21, -0.13};
  const Standing at = standing_at(grade_of(tilt), Pose2{});
  CHECK(at.roll == doctest::Approx(tilt.roll));
  CHECK(at.pitch == doctest::Approx(tilt.pitch));
  CHECK(at.z == 0.0);
}

TEST_CASE("a robot that turns round on a plane has its tilt turned round") {
  const Grade plane{.rise_x = 0.2, .rise_y = 0.0};
  const Standing up = standing_at(plane, Pose2{});
  const Standing down = standing_at(plane, {1.0, 0.5, std::numbers::pi});
  const Standing across = standing_at(plane, {0.0, 0.0, std::numbers::pi / 2.0});
  CHECK(up.pitch == doctest::Approx(-std::atan(0.2)));
  CHECK(down.pitch == doctest::Approx(std::atan(0.2)));
  CHECK(down.z == doctest::Approx(0.2));
  CHECK(across.roll == doctest::Approx(-std::atan(0.2)));
  CHECK(std::abs(across.pitch) < 1e-12);
}

TEST_CASE("a map that is a plane tilts a robot as the plane does, wherever the path begins on it") {
  Eigen::MatrixXd nodes(21, 21);
  for (Eigen::Index i = 0; i < 21; ++i) {
    for (Eigen::Index j = 0; j < 21; ++j) {
      nodes(i, j) = 0.15 * static_cast<double>(j) - 0.1 * static_cast<double>(i);
    }
  }
  const MappedGround ground{std::make_shared<const ElevationMap>(nodes, Eigen::Vector2d(-10.0, -10.0), 1.0),
                            {1.0, 2.0, 0.7}};
  const Grade plane{.rise_x = 0.15 * std::cos(0.7) - 0.1 * std::sin(0.7),
                    .rise_y = -0.15 * std::sin(0.7) - 0.1 * std::cos(0.7)};
  const Pose2 pose{1.3, -0.4, 0.9};
  CHECK(standing_at(ground, pose).z == doctest::Approx(standing_at(plane, pose).z));
  CHECK(standing_at(ground, pose).roll == doctest::Approx(standing_at(plane, pose).roll));
  CHECK(standing_at(ground, pose).pitch == doctest::Approx(standing_at(plane, pose).pitch));
}

TEST_CASE("from one side of a wrap to the other, an attitude goes the shorter way") {
  const MeasuredTilts measured{{{0.0, 6.2, 0.02}, {1.0, 0.1, 6.26}}};
  CHECK(std::sin(tilt_between(measured, 0.5).roll) ==
        doctest::Approx(std::sin(0.5 * (6.2 + 0.1 - 2.0 * std::numbers::pi))));
  CHECK(std::cos(tilt_between(measured, 0.5).pitch) > 0.999);
}

TEST_CASE("a measured attitude is interpolated, held outside, and tells no height") {
  const MeasuredTilts measured{{{1.0, 0.0, 0.1}, {2.0, 0.2, 0.3}}};
  CHECK(tilt_between(measured, 1.25).roll == doctest::Approx(0.05));
  CHECK(tilt_between(measured, 1.25).pitch == doctest::Approx(0.15));
  CHECK(tilt_between(measured, 0.0).pitch == 0.1);
  CHECK(tilt_between(measured, 5.0).roll == 0.2);
  CHECK(tilt_between({}, 5.0).roll == 0.0);
  CHECK_THROWS_AS(static_cast<void>(standing_at(measured, Pose2{})), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
