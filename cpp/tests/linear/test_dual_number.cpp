// SPDX-License-Identifier: Apache-2.0
// Derivatives that are carried along are those of the formula.
#include <doctest/doctest.h>

#include <Eigen/Core>

#include "finite_difference.hpp"
#include "slipwise/linear/dual_number.hpp"

namespace slipwise {
namespace {

template <class Scalar>
Scalar formula(const Scalar& x, const Scalar& y, const Scalar& z) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  return sqrt(Scalar(1.0) + x * x * y) / (Scalar(2.0) - cos(z)) - (-(sin(y) * z)) + x / y;
}

TEST_CASE("a formula of dual numbers has its value and its exact derivatives") {
  const Eigen::Vector3d at(0.7, 1.3, -0.4);
  const Dual3 dual = formula(Dual3::variable(at[0], 0), Dual3::variable(at[1], 1), Dual3::variable(at[2], 2));
  const auto value = [](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(1, formula(p[0], p[1], p[2]));
  };
  CHECK(dual.value == formula(at[0], at[1], at[2]));
  CHECK((dual.by - tests::finite_difference(value, at, 1e-3)).norm() < 1e-9);
  CHECK(value_of(dual) == dual.value);
}

TEST_CASE("a constant has no derivative") { CHECK(Dual3(3.0).by.isZero(0.0)); }

}  // namespace
}  // namespace slipwise
