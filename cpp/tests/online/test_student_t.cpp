// SPDX-License-Identifier: Apache-2.0
// The fraction inside an ellipsoid of a Student t in three dimensions.
#include "slipwise/online/student_t.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace slipwise {
namespace {

/// Of chi-square with 3 degrees of freedom.
double chi_square_inside(double squared) {
  const double r = std::sqrt(squared);
  return std::erf(r / std::sqrt(2.0)) - std::sqrt(2.0 / 3.141592653589793) * r * std::exp(-squared / 2.0);
}

TEST_CASE("a t of many degrees of freedom is nearly normal") {
  for (const double squared : {0.5, 2.366, 6.251, 7.815}) {
    CAPTURE(squared);
    CHECK(fraction_inside(squared, kMostDof) == doctest::Approx(chi_square_inside(squared)).epsilon(0.02));
  }
}

TEST_CASE("the fraction rises from nothing to all") {
  for (const double dof : {kLeastDof, 4.0, 10.0, kMostDof}) {
    CAPTURE(dof);
    CHECK(fraction_inside(0.0, dof) == 0.0);
    CHECK(fraction_inside(1e9, dof) == doctest::Approx(1.0));
    CHECK(fraction_inside(1.0, dof) < fraction_inside(2.0, dof));
  }
}

TEST_CASE("it is what drawn errors show") {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  constexpr double kDof = 5.0;
  std::chi_squared_distribution<double> chi_square(kDof);
  constexpr int kDraws = 40000;
  int inside = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double scale = (kDof - 2.0) / chi_square(random);  // of unit covariance
    const double x = normal(random);
    const double y = normal(random);
    const double z = normal(random);
    inside += scale * (x * x + y * y + z * z) < 3.0 ? 1 : 0;
  }
  CHECK(static_cast<double>(inside) / kDraws == doctest::Approx(fraction_inside(3.0, kDof)).epsilon(0.01));
}

}  // namespace
}  // namespace slipwise
