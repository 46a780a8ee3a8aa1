// SPDX-License-Identifier: Apache-2.0
// How far slip is now from what was learned, under one candidate of its disturbance (derivations/uncertainty.md).
#pragma once

#include <Eigen/Core>
#include <utility>

#include "slipwise/linear/rows.hpp"
#include "slipwise/motion/disturbance_model.hpp"

namespace slipwise {

/// A segment as it was expected without any deviation, and how a deviation would show in it.
struct ObservedSlip {
  using ByDeviation = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostRows, kMostDisturbed>;
  double start;          ///< [s]
  double end;            ///< [s]
  Rows innovation;       ///< measured minus expected
  RowsCovariance noise;  ///< its covariance, were the parameters known
  ByDeviation by_deviation;
};

/// A Kalman filter over the deviation of the disturbed terms. It holds still within a segment and decays between their
/// middles.
class SlipDeviation {
 public:
  using State = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostDisturbed, 1>;
  using StateMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostDisturbed, kMostDisturbed>;

  SlipDeviation(const SlipDisturbance& disturbance, const DisturbedTerms& terms);

  /// How many terms have a disturbance.
  Eigen::Index size() const { return mean_.size(); }
  /// Takes in a segment that follows all that were taken in before.
  void follow(const ObservedSlip& observed);
  /// Mean and covariance of its mean over [start, end], which follows all that it has observed.
  std::pair<State, StateMatrix> mean_over(double start, double end) const;

 private:
  void decay_to(double t);

  double time_constant_;
  double t_ = 0.0;
  bool known_ = false;
  State mean_;
  StateMatrix nominal_;  ///< covariance before anything is observed
  StateMatrix covariance_;
};

}  // namespace slipwise
