// SPDX-License-Identifier: Apache-2.0
// Fitting a Student t to errors, one after another.
#include "slipwise/online/student_calibration.hpp"

#include <doctest/doctest.h>

#include <random>

#include "slipwise/online/student_t.hpp"

namespace slipwise {
namespace {

/// Squared lengths of errors whose covariance is `factor` times as large as reported.
std::vector<double> drawn(std::uint64_t seed, int count, double factor, double dof) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::chi_squared_distribution<double> chi_square(dof);
  std::vector<double> squares;
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double x = normal(random);
      sum += x * x;
    }
    squares.push_back(factor * sum * (dof - 2.0) / chi_square(random));
  }
  return squares;
}

TEST_CASE("how large errors are is learned, and the ellipsoids hold what they say") {
  for (const double factor : {0.3, 1.0, 8.0}) {
    CAPTURE(factor);
    StudentCalibration calibration;
    for (const double squared : drawn(1, 400, factor, 5.0)) {
      calibration.learn(squared);
    }
    const StudentT found = calibration.fitted();
    CHECK(found.inflation == doctest::Approx(factor).epsilon(0.4));
    CHECK(found.dof < 15.0);
    int inside = 0;
    for (const double squared : drawn(2, 4000, factor, 5.0)) {
      inside += fraction_inside(squared / found.inflation, found.dof) < 0.9 ? 1 : 0;
    }
    CHECK(inside / 4000.0 == doctest::Approx(0.9).epsilon(0.03));
  }
}

TEST_CASE("before any error the covariance is taken about as reported") {
  const StudentT nothing = StudentCalibration().fitted();
  CHECK(nothing.inflation > 0.5);
  CHECK(nothing.inflation < 4.0);
  CHECK(nothing.dof > kLeastDof);
}

TEST_CASE("errors that grow are followed") {
  StudentCalibration calibration;
  for (const double squared : drawn(3, 200, 0.2, 8.0)) {
    calibration.learn(squared);
  }
  const double before = calibration.fitted().inflation;
  for (const double squared : drawn(4, 60, 5.0, 8.0)) {
    calibration.learn(squared);
  }
  CHECK(calibration.fitted().inflation > 5.0 * before);
}

TEST_CASE("an error of any size leaves a number") {
  StudentCalibration calibration;
  for (const double squared : {0.0, 1e300, 1e-300, 3.0}) {
    calibration.learn(squared);
    CHECK(calibration.fitted().inflation > 0.0);
    CHECK(calibration.fitted().inflation < 1e6);
  }
}

}  // namespace
}  // namespace slipwise
