// SPDX-License-Identifier: Apache-2.0
// Slip noise along a rollout, period by period: how much each period's motion scatters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/disturbance_model.hpp"
#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/rollout/rollout_batch.hpp"

namespace slipwise {

/// The learned uncertainty of a model.
struct ModelUncertainty {
  Eigen::MatrixXd covariance;                       ///< of the parameters
  MotionNoise noise;                                ///< its pose noise is not used: a rollout starts at a given pose
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  ///< learned factor of the variances of (x, y, theta)
  double inflation = 1.0;                           ///< factor of all variances at the horizon in question
  DisturbanceModel disturbance{};                   ///< of slip about the parameters
  Eigen::VectorXd prior_std{};                      ///< of the parameters, where slip has a disturbance
  /// [slip, stretches] each: independent errors of the slip ahead (mixed_ahead.hpp), in place of the covariance of
  /// slip.
  std::vector<Eigen::MatrixXd> ahead{};
};

/// A model with its parameters, how uncertain it is, and what stays the same over all rollouts.
struct UncertainModel {
  const MotionModel& model;
  Eigen::VectorXd parameters;
  ModelUncertainty uncertainty;
  RolloutSetting setting;
};

/// \throws std::invalid_argument when the covariance does not fit the parameters, or a number is negative or not
/// finite.
void check_uncertainty(const UncertainModel& model);

/// The disturbed terms; none without a law.
DisturbedTerms disturbed_terms_of(const UncertainModel& model);

/// The model that only drives: no slip, the same actuator. Its paths say how far the drive moves.
RolloutProgram drive_alone(const UncertainModel& model);

/// The model with other parameters, and the slip of all stretches moved by `ahead` [slip, stretches], which has no
/// columns where it stays.
RolloutProgram moved(const UncertainModel& model, Eigen::VectorXd parameters, const Eigen::MatrixXd& ahead);

/// The paths of all rollouts, [periods * rollouts] each.
struct RolloutPaths {
  std::size_t rollouts = 0;
  std::size_t periods = 0;
  std::vector<double> x, y, theta;

  Pose2 at(std::size_t period, std::size_t rollout) const {
    const std::size_t i = period * rollouts + rollout;
    return {x[i], y[i], theta[i]};
  }
};

RolloutPaths roll_paths(const RolloutProgram& program, const RolloutBatch<double>& batch,
                        const RolloutOptions& options);

/// The constant twist that leads from one pose to the next over a period, times its length; its turn is not wrapped.
Eigen::Vector3d period_tangent(const Pose2& before, const Pose2& after);

/// What slip noise does over one period in which the drive alone would move by `drive` (forward, left, turn):
/// the variance of its white part, and the standard deviation of its part that is constant along the path.
struct PeriodNoise {
  std::array<double, 3> variance;
  std::array<double, 3> constant;
};
PeriodNoise period_noise(const Eigen::Vector3d& drive, double period, const MotionNoise& noise);

}  // namespace slipwise
