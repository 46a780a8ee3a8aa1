// SPDX-License-Identifier: Apache-2.0
// Dynamics for tests: a cart with drag that is driven by a force, and a hand that turns with a learned gain.
#pragma once

#include <cmath>

#include "slipwise/dynamics/dynamics_model.hpp"

namespace slipwise::tests {

/// State (place [m], speed [m/s]), input force per mass [m/s^2], parameters (linear drag [1/s], gain of the force).
class Cart final : public DynamicsModel {
 public:
  Eigen::VectorXd derivative(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                             const Eigen::VectorXd& parameters) const override {
    return Eigen::Vector2d(state[1], parameters[1] * input[0] - parameters[0] * state[1]);
  }
};

/// The same with its exact derivatives.
class CartWithJacobians final : public DynamicsModel {
 public:
  Eigen::VectorXd derivative(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                             const Eigen::VectorXd& parameters) const override {
    return Cart().derivative(state, input, parameters);
  }
  DynamicsJacobians jacobians(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                              const Eigen::VectorXd& parameters) const override {
    Eigen::Matrix2d by_state;
    by_state << 0.0, 1.0, 0.0, -parameters[0];
    Eigen::Matrix2d by_parameter;
    by_parameter << 0.0, 0.0, -state[1], input[0];
    return {.by_state = by_state, .by_parameter = by_parameter};
  }
};

/// State: an angle [rad]; input: a rate [rad/s]; parameter: its gain.
class Hand final : public DynamicsModel {
 public:
  Eigen::VectorXd derivative(const Eigen::VectorXd& /*state*/, const Eigen::VectorXd& input,
                             const Eigen::VectorXd& parameters) const override {
    return parameters[0] * input;
  }
};

/// State (heading [rad], speed [m/s], x [m]): not linear in any of them; parameters (drag per speed [1/m], turn gain).
class Boat final : public DynamicsModel {
 public:
  Eigen::VectorXd derivative(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                             const Eigen::VectorXd& parameters) const override {
    return Eigen::Vector3d(parameters[1] * input[1], input[0] - parameters[0] * state[1] * std::abs(state[1]),
                           state[1] * std::cos(state[0]));
  }
};

}  // namespace slipwise::tests
