// SPDX-License-Identifier: Apache-2.0
// The search on functions whose minimum is known.
#include "slipwise/linear/gauss_newton.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace slipwise {
namespace {

/// Rosenbrock's valley as a sum of squares, (1 - x)^2 + 100 (y - x^2)^2.
double valley_cost(const Eigen::VectorXd& at) {
  return std::pow(1.0 - at[0], 2) + 100.0 * std::pow(at[1] - at[0] * at[0], 2);
}

NormalEquations valley_equations(const Eigen::VectorXd& at) {
  const Eigen::Vector2d r(1.0 - at[0], 10.0 * (at[1] - at[0] * at[0]));
  Eigen::Matrix2d jacobian;
  jacobian << -1.0, 0.0, -20.0 * at[0], 10.0;
  return {jacobian.transpose() * jacobian, -jacobian.transpose() * r};
}

GaussNewton searched(const DescentSettings& settings) {
  GaussNewton search(Eigen::Vector2d(-1.2, 1.0), settings);
  NormalEquations at_best;
  while (!search.over()) {
    if (search.judge(valley_cost(search.candidate()))) {
      at_best = valley_equations(search.candidate());
    }
    search.propose(at_best);
  }
  return search;
}

TEST_CASE("it finds the end of a bent valley") {
  const GaussNewton search = searched({.iterations = 100, .relative = 1e-10});
  CHECK(search.converged());
  CHECK((search.best() - Eigen::Vector2d(1.0, 1.0)).norm() < 1e-5);
  CHECK(search.cost() == doctest::Approx(valley_cost(search.best())));
}

TEST_CASE("the best is never above the start, and too few iterations are no convergence") {
  const GaussNewton search = searched({.iterations = 3});
  CHECK_FALSE(search.converged());
  CHECK(search.iterations() == 3);
  CHECK(search.cost() <= valley_cost(Eigen::Vector2d(-1.2, 1.0)));
}

TEST_CASE("no parameter goes further than the longest step at once") {
  GaussNewton search(Eigen::VectorXd::Constant(1, 0.0), {.iterations = 1, .longest_step = 0.25});
  search.judge(100.0);
  search.propose({Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, 10.0)});
  CHECK(search.candidate()[0] == 0.25);
}

TEST_CASE("what is not worth a step is not looked at") {
  GaussNewton search(Eigen::VectorXd::Constant(1, 0.0), {.iterations = 5, .absolute = 0.1});
  search.judge(1.0);
  search.propose({Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, 0.2)});
  CHECK(search.over());
  CHECK(search.converged());
  CHECK(search.iterations() == 0);
}

}  // namespace
}  // namespace slipwise
