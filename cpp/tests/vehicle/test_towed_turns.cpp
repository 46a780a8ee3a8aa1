// SPDX-License-Identifier: Apache-2.0
// In a circle a trailer turns as the robot does; where it begins, by the way that it was pulled.
#include "slipwise/vehicle/towed_turns.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace slipwise {
namespace {

constexpr double kMostFolded = 1.5;

TEST_CASE("trailers come to turn as the robot does, those of longer ones later, and fold no further than they may") {
  constexpr Eigen::Index kSteps = 600;
  const Eigen::VectorXd forward = Eigen::VectorXd::Constant(kSteps, 0.1);
  const Eigen::VectorXd rotation = Eigen::VectorXd::Constant(kSteps, 0.03);  // a circle of 3.3 m
  const std::array trailers{Trailer{0.5, 1.0, 0.0}, Trailer{2.0, 0.6, 0.3}, Trailer{5.0, 1.0, 0.0}};
  const Eigen::MatrixXd turned = towed_turns(forward, rotation, trailers, kMostFolded, 2);
  CHECK(turned(kSteps - 1, 0) == doctest::Approx(0.03).epsilon(1e-6));
  CHECK(turned(kSteps - 1, 1) == doctest::Approx(0.018).epsilon(1e-6));
  CHECK(turned(5, 0) > turned(5, 2));
  const double folded = 0.1 * std::sin(kMostFolded) / 5.0;  // its axle would lie outside the circle
  CHECK(turned(kSteps - 1, 2) == doctest::Approx(folded).epsilon(1e-9));
}

TEST_CASE("a trailer behind the axle first turns against the robot; straight on none turns") {
  const Eigen::Vector2d rotation(0.1, 0.0);
  const std::array trailers{Trailer{1.0, 1.0, 0.3}};
  const Eigen::MatrixXd turned = towed_turns(Eigen::Vector2d::Zero(), rotation, trailers, kMostFolded, 1);
  CHECK(turned(0, 0) == doctest::Approx(-0.03));
  CHECK(turned(1, 0) == 0.0);
  CHECK_THROWS_AS(towed_turns(Eigen::Vector3d::Zero(), rotation, trailers, kMostFolded, 1), std::invalid_argument);
  CHECK_THROWS_AS(towed_turns(rotation, rotation, trailers, kMostFolded, 0), std::invalid_argument);
  CHECK_THROWS_AS(towed_turns(rotation, rotation, trailers, -1.0, 1), std::invalid_argument);
  const std::array pointless{Trailer{0.0, 1.0, 0.3}};
  CHECK_THROWS_AS(towed_turns(rotation, rotation, pointless, kMostFolded, 1), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
