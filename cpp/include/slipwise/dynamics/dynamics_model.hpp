// SPDX-License-Identifier: Apache-2.0
// A user's own dynamics: how a state moves under inputs and parameters that are to be learned (thesis 2.2).
#pragma once

#include <Eigen/Core>

namespace slipwise {

/// Derivatives of a state's rate of change.
struct DynamicsJacobians {
  Eigen::MatrixXd by_state;      ///< [states, states]
  Eigen::MatrixXd by_parameter;  ///< [states, parameters]
};

/// x' = f(x, u, p). The parameters may enter in any way; where they enter linearly, the filter is exact in them over
/// short windows.
class DynamicsModel {
 public:
  DynamicsModel() = default;
  DynamicsModel(const DynamicsModel&) = default;
  DynamicsModel(DynamicsModel&&) = default;
  DynamicsModel& operator=(const DynamicsModel&) = default;
  DynamicsModel& operator=(DynamicsModel&&) = default;
  virtual ~DynamicsModel() = default;

  /// Rate of change of the state, [states].
  virtual Eigen::VectorXd derivative(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                                     const Eigen::VectorXd& parameters) const = 0;
  /// The same of several states and parameters, a column each, under one input. Whoever computes many at once
  /// overrides it.
  virtual Eigen::MatrixXd derivatives(const Eigen::MatrixXd& states, const Eigen::VectorXd& input,
                                      const Eigen::MatrixXd& parameters) const;
  /// Central differences of `derivatives` where it is not overridden.
  virtual DynamicsJacobians jacobians(const Eigen::VectorXd& state, const Eigen::VectorXd& input,
                                      const Eigen::VectorXd& parameters) const;
};

}  // namespace slipwise
