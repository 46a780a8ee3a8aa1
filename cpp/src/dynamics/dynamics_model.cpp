// SPDX-License-Identifier: Apache-2.0
// Derivatives of a user's dynamics by central differences.
#include "slipwise/dynamics/dynamics_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipwise {
namespace {

/// Half the distance between two points of a central difference about `value`: errors of rounding and of the third
/// derivative are alike there.
double half_step(double value) {
  return std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(value));
}

}  // namespace

Eigen::MatrixXd DynamicsModel::derivatives(const Eigen::MatrixXd& states, const Eigen::VectorXd& input,
                                           const Eigen::MatrixXd& parameters) const {
  Eigen::MatrixXd rates(states.rows(), states.cols());
  for (Eigen::Index i = 0; i < states.cols(); ++i) {
    rates.col(i) = derivative(states.col(i), input, parameters.col(i));
  }
  return rates;
}

DynamicsJacobians DynamicsModel::jacobians(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                                           const Eigen::VectorXd& parameters) const {
  const Eigen::Index n = state.size();
  const Eigen::Index all = n + parameters.size();
  Eigen::VectorXd at(all);
  at << state, parameters;
  Eigen::MatrixXd points = at.replicate(1, 2 * all);
  Eigen::VectorXd width(all);
  for (Eigen::Index i = 0; i < all; ++i) {
    const double half = half_step(at[i]);
    points(i, 2 * i) += half;
    points(i, 2 * i + 1) -= half;
    width[i] = points(i, 2 * i) - points(i, 2 * i + 1);
  }
  const Eigen::MatrixXd rates = derivatives(points.topRows(n), input, points.bottomRows(parameters.size()));
  Eigen::MatrixXd by(n, all);
  for (Eigen::Index i = 0; i < all; ++i) {
    by.col(i) = (rates.col(2 * i) - rates.col(2 * i + 1)) / width[i];
  }
  return {.by_state = by.leftCols(n), .by_parameter = by.rightCols(parameters.size())};
}

}  // namespace slipwise
