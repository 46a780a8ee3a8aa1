// SPDX-License-Identifier: Apache-2.0
// Slip becomes another where an edge is passed, as much of a step as lies beyond it.
#include "slipwise/slip/slip_ahead.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace slipwise {
namespace {

const Eigen::Vector2d kFirst(0.1, 0.2);
const SlipAhead kAhead{.edges = {1.0, 2.0}, .changes = {Eigen::Vector2d(0.1, 0.0), Eigen::Vector2d(0.0, -0.2)}};

TEST_CASE("a step is on what it is driven on, and on an edge on both by their lengths") {
  CHECK(slip_over(kAhead, kFirst, 0.0, 0.5) == Eigen::VectorXd(kFirst));
  CHECK(slip_over(kAhead, kFirst, 1.2, 0.5).isApprox(Eigen::Vector2d(0.2, 0.2)));
  CHECK(slip_over(kAhead, kFirst, 5.0, 0.0).isApprox(Eigen::Vector2d(0.2, 0.0)));
  const double beyond = fraction_beyond(1.0, 0.9, 0.2);
  CHECK(beyond == doctest::Approx(0.5).epsilon(0.01));
  CHECK(slip_over(kAhead, kFirst, 0.9, 0.2).isApprox(kFirst + beyond * kAhead.changes[0]));
}

TEST_CASE("a robot that turns on one spot is on one side of an edge") {
  CHECK(fraction_beyond(1.0, 0.99, 0.0) == 0.0);
  CHECK(fraction_beyond(1.0, 1.01, 0.0) == 1.0);
}

TEST_CASE("edges that do not increase, and changes of other terms, are refused") {
  const Eigen::Vector2d none(0.0, 0.0);
  CHECK_NOTHROW(check_ahead(kAhead, 2));
  CHECK_THROWS_AS(check_ahead(kAhead, 3), std::invalid_argument);
  CHECK_THROWS_AS(check_ahead({.edges = {2.0, 1.0}, .changes = {none, none}}, 2), std::invalid_argument);
  CHECK_THROWS_AS(check_ahead({.edges = {0.0}, .changes = {none}}, 2), std::invalid_argument);
  CHECK_THROWS_AS(check_ahead({.edges = {1.0}, .changes = {}}, 2), std::invalid_argument);
  CHECK_THROWS_AS(check_ahead({.edges = {std::numeric_limits<double>::infinity()}, .changes = {none}}, 2),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
