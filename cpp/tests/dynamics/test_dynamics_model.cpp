// SPDX-License-Identifier: Apache-2.0
// Central differences of a user's dynamics are its derivatives.
#include <doctest/doctest.h>

#include "sample_dynamics.hpp"

namespace slipwise {
namespace {

TEST_CASE("derivatives by central differences are those that a user would write") {
  const Eigen::Vector2d state(3.0, -120.0), parameters(0.2, 1.5);
  const Eigen::VectorXd input = Eigen::VectorXd::Constant(1, 0.7);
  const DynamicsJacobians found = tests::Cart().jacobians(state, input, parameters);
  const DynamicsJacobians exact = tests::CartWithJacobians().jacobians(state, input, parameters);
  CHECK((found.by_state - exact.by_state).norm() < 1e-8);
  CHECK((found.by_parameter - exact.by_parameter).norm() < 1e-8 * 120.0);
}

TEST_CASE("several states at once have the rates of each") {
  const Eigen::Matrix2d states = Eigen::Matrix2d::Random();
  const Eigen::Matrix2d parameters = Eigen::Matrix2d::Random();
  const Eigen::VectorXd input = Eigen::VectorXd::Constant(1, 0.7);
  const Eigen::MatrixXd rates = tests::Cart().derivatives(states, input, parameters);
  for (Eigen::Index i = 0; i < 2; ++i) {
    CHECK(rates.col(i) == tests::Cart().derivative(states.col(i), input, parameters.col(i)));
  }
}

}  // namespace
}  // namespace slipwise
