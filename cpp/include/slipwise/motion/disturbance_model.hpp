// SPDX-License-Identifier: Apache-2.0
// The slip disturbance about what was learned: Gauss-Markov processes on its linear terms
// (derivations/uncertainty.md).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/motion/motion_model.hpp"

namespace slipwise {

/// One candidate of the slip disturbance: first-order Gauss-Markov processes of one time constant.
struct SlipDisturbance {
  double linear;         ///< of the forward and sideways terms, as a fraction of their prior std [-]
  double angular;        ///< of the angular terms [-]
  double time_constant;  ///< [s]
};

/// The slip disturbance, as far as it is known: candidates and how likely each is. Without any, there is none.
struct DisturbanceModel {
  std::vector<SlipDisturbance> candidates;
  Eigen::VectorXd weights;  ///< not negative, their sum is 1
};

/// The terms that may have a disturbance: the fractions of V in the forward and sideways slip rates, of V and w in the
/// angular one.
struct DisturbedTerms {
  std::vector<Eigen::Index> places;  ///< of their parameters
  Eigen::VectorXd prior_std;         ///< [places]
  std::vector<Channel> channels;     ///< [places]
  std::vector<bool> of_turn;         ///< [places]; fractions of w, the others of V

  Eigen::Index size() const { return prior_std.size(); }
  /// Variances of the terms under one guess, before anything recent is known.
  Eigen::VectorXd variances(const SlipDisturbance& disturbance) const;
};

inline constexpr Eigen::Index kMostDisturbed = 4;

/// \throws std::invalid_argument when there is not one prior standard deviation per parameter.
DisturbedTerms disturbed_terms(const MotionModel& model, const Eigen::Ref<const Eigen::VectorXd>& prior_std);

/// For how long slip differs from what was learned [s]: as `usual` until candidates for longer have three quarters of
/// the weight, as long as these say where they have all of it.
double correlation_time(const DisturbanceModel& law, double usual);

/// Mean, over a time of `spans` time constants, of what such a process keeps of its value at the start.
double kept_over(double spans);
/// Variance of the mean, over a time of `spans` time constants, of such a process of variance 1.
double variance_over(double spans);

/// Variances, of the terms, of the mean of slip over `seconds` about what was learned, when nothing recent is known.
Eigen::VectorXd nominal_variances(const DisturbanceModel& law, const DisturbedTerms& terms, double seconds);

/// Covariance of the parameters' mean over `seconds`: that of what was learned, and of the the slip disturbance about
/// it.
Eigen::MatrixXd covariance_over(const MotionModel& model, const Eigen::Ref<const Eigen::MatrixXd>& learned,
                                const DisturbanceModel& law, const Eigen::Ref<const Eigen::VectorXd>& prior_std,
                                double seconds);

/// \throws std::invalid_argument when there is not one weight per candidate, a number is negative or not finite, a time
/// constant is not positive, or the weights' sum is not 1.
void check_disturbance(const DisturbanceModel& law);

}  // namespace slipwise
