// SPDX-License-Identifier: Apache-2.0
// Non-negative least squares: optimality by its conditions, on random problems.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <stdexcept>

#include "slipwise/linear/nonnegative.hpp"

namespace slipwise {
namespace {

TEST_CASE("the solution of random problems meets the conditions of the optimum") {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  int held = 0;
  for (int problem = 0; problem < 200; ++problem) {
    const Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(8, 6, [&]() { return normal(random); });
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(6, [&]() { return normal(random); });
    const Eigen::MatrixXd a = rows.transpose() * rows;
    const Eigen::VectorXd near = Eigen::VectorXd::NullaryExpr(6, [&]() { return std::max(0.0, normal(random)); });
    const Eigen::VectorXd x = nonnegative_solution(a, b, problem % 2 == 0 ? Eigen::VectorXd::Zero(6) : near);
    const Eigen::VectorXd gradient = a * x - b;
    CHECK(x.minCoeff() >= 0.0);
    CHECK(gradient.minCoeff() > -1e-9);
    CHECK(x.cwiseProduct(gradient).lpNorm<Eigen::Infinity>() < 1e-9);
    held += static_cast<int>((x.array() == 0.0).count());
  }
  CHECK(held > 200);
}

TEST_CASE("a matrix that is not positive definite is refused") {
  const Eigen::Vector2d ones(1, 1);
  CHECK_THROWS_AS(nonnegative_solution(Eigen::MatrixXd::Zero(2, 2), ones, ones), std::invalid_argument);
  CHECK_THROWS_AS(nonnegative_solution(Eigen::MatrixXd::Identity(3, 3), ones, ones), std::invalid_argument);
}

}  // namespace
}  // namespace slipwise
