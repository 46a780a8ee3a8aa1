// SPDX-License-Identifier: Apache-2.0
// State and parameters of a user's dynamics, learned together from one measurement after the other
// (derivations/slopes-and-forces.md).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "slipwise/dynamics/dynamics_model.hpp"
#include "slipwise/dynamics/held_inputs.hpp"
#include "slipwise/dynamics/integrate_dynamics.hpp"
#include "slipwise/filter/estimate.hpp"
#include "slipwise/filter/iekf.hpp"
#include "slipwise/filter/score_covariance.hpp"
#include "slipwise/filter/window_model.hpp"

namespace slipwise {

/// The measured part of a state, and its disturbance.
struct DynamicsNoise {
  std::vector<Eigen::Index> measured;  ///< [M] places in the state
  std::vector<bool> angle;             ///< [M] whether a measured component is an angle [rad]
  Eigen::VectorXd measurement_std;     ///< [M] of each measurement, in its unit
  Eigen::VectorXd psd;                 ///< [states] of what adds to the state's rate, its unit squared per second
};

struct DynamicsSettings {
  DynamicsNoise noise;
  double longest_step = 0.05;  ///< of the integrator [s]
  IekfSettings iekf = {};      ///< gate and Huber's bound, as if of three measurements
};

/// One measurement's update.
struct DynamicsUpdate {
  Eigen::VectorXd innovation;  ///< [M] measured minus predicted
  double nis;                  ///< normalised innovation squared; M where the covariance is true
  double weight;               ///< 1 where nothing was unusual, 0 where rejected
  Status status;
};

/// What will be measured.
struct DynamicsPrediction {
  double t;                    ///< [s]
  Eigen::VectorXd state;       ///< [states]
  Eigen::MatrixXd covariance;  ///< [states, states], that of the parameters and of the motion's noise included
};

/// An iterated extended Kalman filter of (state, parameters). Between two measurements the state is integrated with its
/// derivatives, so that a measurement speaks of the parameters by what they did on the way.
class DynamicsFilter {
 public:
  /// `start` is the state at `t` [s] and the parameters, with their covariance.
  /// \throws std::invalid_argument when sizes do not fit, or a number is not finite or negative where it must not be.
  DynamicsFilter(std::shared_ptr<const DynamicsModel> model, const DynamicsSettings& settings, double t,
                 const Estimate& start);

  /// Held from `t` [s] on.
  void push_input(double t, const Eigen::VectorXd& input) { inputs_.push(t, input); }
  /// Learns what was measured at `t` [s]. Inputs of later stamps are not used.
  /// \throws std::invalid_argument when it is no later than the last one or more than an hour later, no input is
  /// known, or it is not finite.
  DynamicsUpdate push_measurement(double t, const Eigen::VectorXd& measured);
  /// Where the state will be at `times` [s], in order, under `future` inputs, or what is held now where there are none.
  /// \throws std::invalid_argument when a time lies before the last measurement or more than an hour after
  /// it.
  std::vector<DynamicsPrediction> predict(const std::vector<double>& times, const HeldInputs& future) const;

  double time() const { return t_; }  ///< of the last measurement [s]
  Estimate state() const;             ///< now
  Estimate parameters() const;        ///< as the filter takes them to be known
  /// With a covariance that also holds where residuals are larger than the noise said, or correlated in time
  /// (derivations/uncertainty.md).
  Estimate reported_parameters() const;

 private:
  WindowModel window(const Eigen::VectorXd& start, double end) const;
  void add_score(const WindowModel& at, const Eigen::VectorXd& innovation, const Eigen::MatrixXd& noise, double t);
  DynamicsUpdate learned(double t, const Eigen::VectorXd& measured);

  std::shared_ptr<const DynamicsModel> model_;
  DynamicsSettings settings_;
  double t_;
  Eigen::Index states_;
  Estimate now_;           ///< of (state, parameters)
  Eigen::MatrixXd prior_;  ///< of the parameters
  HeldInputs inputs_;
  ScoreCovariance scores_;
  int rejected_in_a_row_ = 0;
};

}  // namespace slipwise
