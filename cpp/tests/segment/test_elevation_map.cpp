// SPDX-License-Identifier: Apache-2.0
// Heights and rises of a map of elevations, inside it and beyond its border.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "slipwise/segment/elevation_map.hpp"

namespace slipwise {
namespace {

/// Heights of a function at nodes half a metre apart from (-2, -1) on, 13 rows and 17 columns.
template <class Height>
ElevationMap sampled(const Height& height) {
  Eigen::MatrixXd nodes(13, 17);
  for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
    for (Eigen::Index j = 0; j < nodes.cols(); ++j) {
      nodes(i, j) = height(-2.0 + 0.5 * static_cast<double>(j), -1.0 + 0.5 * static_cast<double>(i));
    }
  }
  return {nodes, {-2.0, -1.0}, 0.5};
}

TEST_CASE("a plane has its own height and rise everywhere inside, and no bend") {
  const ElevationMap map = sampled([](double x, double y) { return 0.3 * x - 0.1 * y + 2.0; });
  for (const auto& [x, y] : {std::pair(-1.9, -0.9), std::pair(0.13, 2.71), std::pair(5.9, 4.9)}) {
    const auto rise = map.rise(x, y);
    CHECK(map.height(x, y) == doctest::Approx(0.3 * x - 0.1 * y + 2.0));
    CHECK(rise.x == doctest::Approx(0.3));
    CHECK(rise.y == doctest::Approx(-0.1));
    CHECK(std::abs(rise.xx) + std::abs(rise.xy) + std::abs(rise.yx) + std::abs(rise.yy) < 1e-12);
  }
}

TEST_CASE("the rise has the derivatives that it states") {
  const ElevationMap map = sampled([](double x, double y) { return std::sin(0.5 * x) * std::cos(0.4 * y); });
  constexpr double kStep = 1e-5;
  const double x = 1.13;
  const double y = 0.87;
  const auto rise = map.rise(x, y);
  CHECK((map.rise(x + kStep, y).x - map.rise(x - kStep, y).x) / (2.0 * kStep) == doctest::Approx(rise.xx));
  CHECK((map.rise(x, y + kStep).x - map.rise(x, y - kStep).x) / (2.0 * kStep) == doctest::Approx(rise.xy));
  CHECK((map.rise(x + kStep, y).y - map.rise(x - kStep, y).y) / (2.0 * kStep) == doctest::Approx(rise.yx));
  CHECK((map.rise(x, y + kStep).y - map.rise(x, y - kStep).y) / (2.0 * kStep) == doctest::Approx(rise.yy));
  CHECK(rise.x == doctest::Approx(0.5 * std::cos(0.5 * x) * std::cos(0.4 * y)).epsilon(0.05));
}

TEST_CASE("a map goes on beyond its border as it is there") {
  const ElevationMap map = sampled([](double x, double y) { return x * x + y; });
  CHECK(map.height(100.0, 0.3) == map.height(6.0, 0.3));
  CHECK(map.rise(100.0, 0.3).x == map.rise(6.0, 0.3).x);
  CHECK(map.rise(100.0, 0.3).xx == 0.0);
  CHECK(map.holds(6.0, 5.0));
  CHECK(!map.holds(6.01, 0.0));
  CHECK(!map.holds(0.0, -1.01));
}

TEST_CASE("a map that is none is refused") {
  const Eigen::MatrixXd flat = Eigen::MatrixXd::Zero(3, 3);
  Eigen::MatrixXd holed = flat;
  holed(1, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(ElevationMap(Eigen::MatrixXd::Zero(1, 3), {0.0, 0.0}, 1.0), std::invalid_argument);
  CHECK_THROWS_AS(ElevationMap(holed, {0.0, 0.0}, 1.0), std::invalid_argument);
  CHECK_THROWS_AS(ElevationMap(flat, {0.0, 0.0}, 0.0), std::invalid_argument);
  CHECK_THROWS_AS(ElevationMap(flat, {std::numeric_limits<double>::infinity(), 0.0}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
