// SPDX-License-Identifier: Apache-2.0
// A user's dynamics integrated over a stretch of time, with derivatives by state and parameters at its start, and the
// noise that adds up on the way (derivations/slopes-and-forces.md).
#pragma once

#include <Eigen/Core>

#include "slipwise/dynamics/dynamics_model.hpp"
#include "slipwise/dynamics/held_inputs.hpp"

namespace slipwise {

/// From when to when, in which steps, and what disturbs the motion meanwhile.
struct DynamicsSpan {
  double start;                ///< [s]
  double end;                  ///< [s]
  double longest_step;         ///< of the integrator [s]
  const Eigen::VectorXd& psd;  ///< [states] power spectral density of what adds to the state's rate, per second
};

struct DynamicsEnd {
  Eigen::VectorXd state;     ///< [states] at the end
  Eigen::MatrixXd by_start;  ///< [states, states + parameters] by the state at the start and the parameters
  Eigen::MatrixXd noise;     ///< [states, states] covariance of what was added on the way
};

/// Where an integration begins.
DynamicsEnd nothing_passed(const Eigen::VectorXd& state, Eigen::Index parameters);

/// From a state on, by the Runge-Kutta method of fourth order for the state and its derivatives, steps ending where
/// an input changes.
/// \throws std::runtime_error when the state is not finite any more.
DynamicsEnd integrate_dynamics(const DynamicsModel& model, const HeldInputs& inputs, const DynamicsSpan& span,
                               const Eigen::VectorXd& state, const Eigen::VectorXd& parameters);
/// The same from where another one ended; derivatives and noise are those since that began.
DynamicsEnd integrate_dynamics(const DynamicsModel& model, const HeldInputs& inputs, const DynamicsSpan& span,
                               DynamicsEnd now, const Eigen::VectorXd& parameters);

/// Where the state is at the end alone.
Eigen::VectorXd dynamics_state(const DynamicsModel& model, const HeldInputs& inputs, const DynamicsSpan& span,
                               const Eigen::VectorXd& state, const Eigen::VectorXd& parameters);

}  // namespace slipwise
