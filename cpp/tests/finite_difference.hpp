// SPDX-License-Identifier: Apache-2.0
// The one place where derivatives are checked: central differences with Ridders' extrapolation.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <concepts>
#include <limits>

namespace slipwise::tests {

/// Ridders' method for one direction: differences at shrinking steps, extrapolated to a step of zero.
template <std::invocable<double> F>
Eigen::VectorXd ridders_derivative(F f, double step) {
  constexpr std::size_t kRounds = 6;
  constexpr double kShrink = 1.6;
  std::array<std::array<Eigen::VectorXd, kRounds>, kRounds> table;
  Eigen::VectorXd best;
  double best_error = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kRounds; ++i, step /= kShrink) {
    table[i][0] = (f(step) - f(-step)) / (2.0 * step);
    double factor = kShrink * kShrink;
    for (std::size_t j = 1; j <= i; ++j, factor *= kShrink * kShrink) {
      table[i][j] = (factor * table[i][j - 1] - table[i - 1][j - 1]) / (factor - 1.0);
      const double error = std::max((table[i][j] - table[i][j - 1]).template lpNorm<Eigen::Infinity>(),
                                    (table[i][j] - table[i - 1][j - 1]).template lpNorm<Eigen::Infinity>());
      if (error < best_error) {
        best_error = error;
        best = table[i][j];
      }
    }
  }
  return best;
}

/// Derivative of f (VectorXd -> vector) at a point. `step` is the largest that keeps f smooth, the same for all inputs.
template <typename F>
Eigen::MatrixXd finite_difference(F f, const Eigen::VectorXd& at, double step) {
  Eigen::MatrixXd jacobian;
  for (Eigen::Index j = 0; j < at.size(); ++j) {
    const auto along = [&](double h) -> Eigen::VectorXd {
      Eigen::VectorXd point = at;
      point[j] += h;
      return f(point);
    };
    const Eigen::VectorXd column = ridders_derivative(along, step);
    jacobian.conservativeResize(column.size(), at.size());
    jacobian.col(j) = column;
  }
  return jacobian;
}

/// Largest difference of any column, relative to that column's largest entry (or to `floor`, where all are smaller).
inline double jacobian_error(const Eigen::MatrixXd& analytic, const Eigen::MatrixXd& numeric, double floor = 1e-2) {
  double worst = analytic.rows() == numeric.rows() && analytic.cols() == numeric.cols()
                     ? 0.0
                     : std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; worst < std::numeric_limits<double>::infinity() && j < numeric.cols(); ++j) {
    const double size = std::max(numeric.col(j).lpNorm<Eigen::Infinity>(), floor);
    const double error = (analytic.col(j) - numeric.col(j)).lpNorm<Eigen::Infinity>() / size;
    worst = error <= worst ? worst : error;  // keeps NaN
  }
  return worst;
}

/// What "equal to the derivative" means in double precision.
inline constexpr double kDerivativeTolerance = 1e-8;

}  // namespace slipwise::tests
