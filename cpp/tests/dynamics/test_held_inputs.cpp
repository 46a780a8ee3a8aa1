// SPDX-License-Identifier: Apache-2.0
// Inputs are held until the next one, and refused where they cannot be.
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "slipwise/dynamics/held_inputs.hpp"

namespace slipwise {
namespace {

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST_CASE("an input is held until the next") {
  HeldInputs inputs;
  CHECK(inputs.empty());
  inputs.push(1.0, one(10.0));
  inputs.push(2.0, one(20.0));
  CHECK(inputs.first() == 1.0);
  CHECK(inputs.at(1.0)[0] == 10.0);
  CHECK(inputs.at(1.9)[0] == 10.0);
  CHECK(inputs.at(2.0)[0] == 20.0);
  CHECK(inputs.at(99.0)[0] == 20.0);
  CHECK(inputs.until(1.2, 5.0) == 2.0);
  CHECK(inputs.until(1.2, 1.5) == 1.5);
  CHECK(inputs.until(3.0, 5.0) == 5.0);
  CHECK_THROWS_AS(inputs.at(0.5), std::invalid_argument);
}

TEST_CASE("what was replaced is forgotten, what is held is not") {
  HeldInputs inputs;
  for (const double t : {0.0, 1.0, 2.0}) {
    inputs.push(t, one(t));
  }
  inputs.forget_before(1.5);
  CHECK(inputs.first() == 1.0);
  CHECK(inputs.at(1.5)[0] == 1.0);
  inputs.forget_before(9.0);
  CHECK(inputs.at(9.0)[0] == 2.0);
}

TEST_CASE("inputs that are out of order, of another size or not finite are refused") {
  HeldInputs inputs;
  inputs.push(1.0, one(1.0));
  CHECK_THROWS_AS(inputs.push(1.0, one(1.0)), std::invalid_argument);
  CHECK_THROWS_AS(inputs.push(2.0, Eigen::Vector2d(1.0, 1.0)), std::invalid_argument);
  CHECK_THROWS_AS(inputs.push(2.0, one(std::numeric_limits<double>::quiet_NaN())), std::invalid_argument);
  CHECK_THROWS_AS(inputs.push(std::numeric_limits<double>::infinity(), one(1.0)), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
