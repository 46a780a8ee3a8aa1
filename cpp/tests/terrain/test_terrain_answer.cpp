// SPDX-License-Identifier: Apache-2.0
// What is no probability is refused.
#include "slipwise/terrain/terrain_answer.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace slipwise {
namespace {

TEST_CASE("probabilities add up to one, but for rounding, and have names") {
  const Eigen::Vector2d even(0.5, 0.5);
  CHECK_NOTHROW(check_answer({{"ice", "sand"}, Eigen::Vector2d(0.5001, 0.5001), 0.3}));
  CHECK_THROWS_AS(check_answer({{}, Eigen::VectorXd(), 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(check_answer({{"ice", "ice"}, even, 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(check_answer({{"ice", ""}, even, 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(check_answer({{"ice", "sand"}, Eigen::Vector2d(0.5, 0.4), 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(check_answer({{"ice", "sand"}, Eigen::Vector2d(1.5, -0.5), 0.0}), std::invalid_argument);
  CHECK_THROWS_AS(check_answer({{"ice", "sand"}, even, std::numeric_limits<double>::quiet_NaN()}),
                  std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
