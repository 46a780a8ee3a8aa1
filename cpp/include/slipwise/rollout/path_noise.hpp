// SPDX-License-Identifier: Apache-2.0
// How uncertain a model is, for rollouts.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "slipwise/lie/se2.hpp"
#include "slipwise/motion/disturbance_model.hpp"
#include "slipwise/motion/motion_noise.hpp"
#include "slipwise/rollout/lane_noise_job.hpp"
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

/// The model with other parameters, and the slip of all stretches moved by `ahead` [slip, stretches], which has no
/// columns where it stays.
RolloutProgram moved(const UncertainModel& model, Eigen::VectorXd parameters, const Eigen::MatrixXd& ahead);

/// Slip noise as a kernel takes it, with variances widened by these factors. Float and double.
template <typename Scalar>
LaneNoise<Scalar> lane_noise(const MotionNoise& noise, const Eigen::Vector3d& widened = {1.0, 1.0, 1.0});

}  // namespace slipwise
