// SPDX-License-Identifier: Apache-2.0
// Wheel speeds averaged over intervals that end where they are stamped.
#include "slipwise/identify/wheel_means.hpp"

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

namespace slipwise {
namespace {

InputHistory wheels(double period, std::size_t count) {
  std::vector<double> t, v, vy, omega;
  for (std::size_t i = 0; i < count; ++i) {
    t.push_back(static_cast<double>(i) * period);
    v.push_back(static_cast<double>(i));
    vy.push_back(0.0);
    omega.push_back(-1.0);
  }
  return {t, v, vy, omega};
}

TEST_CASE("an interval holds whole samples") {
  const WheelMeans means = wheel_means(wheels(0.05, 40), 0.2, 0.7, 0.1);
  REQUIRE(means.twist.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(means.edges[k + 1] - means.edges[k] == doctest::Approx(0.1));
    CHECK(means.samples[k] == 2.0);
    CHECK(means.twist[k].v == doctest::Approx(4.5 + 2.0 * static_cast<double>(k)));  // samples 4 and 5, 6 and 7, ...
    CHECK(means.twist[k].omega == doctest::Approx(-1.0));
  }
}

TEST_CASE("slow wheels make one interval a sample, and the last is never a sliver") {
  const WheelMeans slow = wheel_means(wheels(0.25, 10), 0.5, 1.5, 0.1);
  CHECK(slow.twist.size() == 4);
  CHECK(slow.samples == std::vector<double>{1.0, 1.0, 1.0, 1.0});
  const WheelMeans ended = wheel_means(wheels(0.05, 40), 0.0, 0.22, 0.1);
  CHECK(ended.edges == std::vector<double>{0.0, 0.1, 0.22});
  CHECK(ended.samples[1] == 3.0);
}

TEST_CASE("a stretch must end after it starts") {
  CHECK_THROWS_AS(wheel_means(wheels(0.05, 4), 0.1, 0.1, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
