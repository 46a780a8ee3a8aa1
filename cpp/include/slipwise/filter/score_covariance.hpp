// SPDX-License-Identifier: Apache-2.0
// How far an estimate really scatters where residuals are larger than their noise model says, or correlated in time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slipwise/filter/estimate.hpp"
#include "slipwise/motion/motion_model.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

/// A measurement as it speaks of parameters.
struct MeasurementScore {
  Eigen::MatrixXd jacobian;    ///< [M, parameters] of what was predicted, by the parameters
  Eigen::VectorXd residual;    ///< [M] measured minus predicted, at the estimate
  Eigen::MatrixXd covariance;  ///< [parameters, parameters] of the estimate
  Eigen::MatrixXd noise;       ///< [M, M] of the measurement, the parameters being known
  double t;                    ///< [s] of its middle
};

/// [s] for which slip differs from what is learned, where nothing is known of it.
inline constexpr double kUsualCorrelationTime = 5.0;

/// Running sums of the scores J^T R^-1 r of segments: their covariance, and that with the scores before them. Compared
/// with the information J^T R^-1 J, they give factors for the variances of an estimate
/// (derivations/uncertainty.md).
class ScoreCovariance {
 public:
  ScoreCovariance() = default;  ///< of a model without parameters
  explicit ScoreCovariance(const MotionModel& model);
  /// Of `size` parameters, those of a group having one factor.
  ScoreCovariance(std::vector<std::vector<Eigen::Index>> groups, Eigen::Index size);

  /// Adds one segment: linearised `at` the estimate whose covariance is given, learned with `noise`. One that says
  /// nothing of the parameters is passed over.
  void add(const SegmentLinearization& at, const Eigen::MatrixXd& covariance, const Segment& segment,
           const RowsCovariance& noise);
  /// Adds one measurement of any size.
  void add(const MeasurementScore& measured);
  /// Forgets all segments.
  void restart();

  /// Factors of the standard deviations of an estimate of this covariance, learned from the segments added and, before
  /// them, from a prior of this covariance. What comes from segments has one factor per channel of slip, and one for
  /// all other parameters; what comes from the prior stays. The kernel's loss is made good for scores that are alike
  /// for `correlation_time` [s].
  Eigen::VectorXd std_factors(const Eigen::MatrixXd& prior, const Eigen::MatrixXd& covariance,
                              double correlation_time = kUsualCorrelationTime) const;

  /// \throws std::invalid_argument where a loaded one does not fit so many parameters.
  void check_loaded(Eigen::Index size) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.groups_, self.information_, self.scatter_, self.lagged_, self.earlier_);
    a(self.segments_, self.earlier_weight_, self.pairs_, self.time_);
  }

 private:
  template <class Jacobian, class Residual, class Noise>
  void add_score(const Jacobian& jacobian, const Residual& residual, const Eigen::MatrixXd& covariance,
                 const Noise& noise, double middle);
  double factor(const std::vector<Eigen::Index>& group, const Eigen::MatrixXd& covariance,
                double correlation_time) const;

  std::vector<std::vector<Eigen::Index>> groups_;  ///< parameters whose factor is one
  Eigen::MatrixXd information_;                    ///< sum of J^T R^-1 J
  Eigen::MatrixXd scatter_;  ///< sum of J^T R^-1 (r r^T + J P J^T) R^-1 J: of the scores, were they independent
  Eigen::MatrixXd lagged_;   ///< sum of each score times the earlier ones, weighted by their age
  Eigen::VectorXd earlier_;  ///< sum of the scores so far, weighted by their age
  double segments_ = 0.0;
  double earlier_weight_ = 0.0;  ///< sum of the weights in `earlier_`
  double pairs_ = 0.0;           ///< sum of the weights in `lagged_`
  double time_ = 0.0;            ///< of the last segment's middle [s]
};

}  // namespace slipwise
