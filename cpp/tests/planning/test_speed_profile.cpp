// SPDX-License-Identifier: Apache-2.0
// Trapezoids and triangles of speed: they cover their length, keep their acceleration, and know their derivatives.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "finite_difference.hpp"
#include "slipwise/planning/speed_profile.hpp"

namespace slipwise {
namespace {

constexpr double kAcceleration = 0.7;

struct Case {
  SpeedEnds ends;
  double length;
};

std::vector<Case> cases() {
  return {{{.start = 0.0, .cruise = 1.2, .end = 0.0}, 6.0}, {{.start = 0.0, .cruise = 1.2, .end = 0.0}, 0.8},
          {{.start = 0.4, .cruise = 1.2, .end = 0.9}, 5.0}, {{.start = 0.9, .cruise = 0.9, .end = 0.0}, 3.0},
          {{.start = 0.5, .cruise = 2.0, .end = 0.5}, 1.0}, {{.start = 0.0, .cruise = 1.0, .end = 1.0}, 0.9},
          {{.start = 1.0, .cruise = 1.0, .end = 1.0}, 2.0}};
}

TEST_CASE("a speed profile covers its length within the cruise speed and the acceleration") {
  for (const Case& c : cases()) {
    const SpeedProfile profile(c.ends, kAcceleration, c.length);
    CHECK(profile.distance(0.0).value == doctest::Approx(0.0));
    CHECK(profile.distance(1.0).value == doctest::Approx(c.length));
    CHECK(profile.peak() <= c.ends.cruise + 1e-12);
    constexpr int kParts = 200;
    const double period = profile.duration().value / kParts;
    double before = c.ends.start;
    for (int k = 0; k < kParts; ++k) {
      const double speed =
          (profile.distance((k + 1.0) / kParts).value - profile.distance(static_cast<double>(k) / kParts).value) /
          period;
      CHECK(std::abs(speed - before) <= kAcceleration * period * (1.0 + 1e-9));
      CHECK(speed <= c.ends.cruise + 1e-9);
      before = speed;
    }
    CHECK(std::abs(c.ends.end - before) <= kAcceleration * period);
  }
}

TEST_CASE("a speed profile's derivatives by its length are its derivatives") {
  for (const Case& c : cases()) {
    for (const double fraction : {0.07, 0.35, 0.5, 0.81, 0.96}) {
      const auto value = [&](const Eigen::VectorXd& length) -> Eigen::VectorXd {
        const SpeedProfile profile(c.ends, kAcceleration, length[0]);
        return Eigen::Vector2d(profile.duration().value, profile.distance(fraction).value);
      };
      const SpeedProfile profile(c.ends, kAcceleration, c.length);
      const Eigen::MatrixXd derivatives =
          Eigen::Vector2d(profile.duration().derivative, profile.distance(fraction).derivative);
      const auto numeric = tests::finite_difference(value, Eigen::VectorXd::Constant(1, c.length), 1e-3);
      CHECK(tests::jacobian_error(derivatives, numeric) < tests::kDerivativeTolerance);
    }
  }
}

}  // namespace
}  // namespace slipwise
