// SPDX-License-Identifier: Apache-2.0
// The slip disturbance about what was learned, and what the last segments say of where it is now.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "slipwise/disturbance/slip_deviation.hpp"
#include "slipwise/filter/hypothesis_bank.hpp"
#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/motion/disturbance_model.hpp"
#include "slipwise/segment/driven_segment.hpp"
#include "slipwise/segment/integrate_segment.hpp"

namespace slipwise {

struct DisturbanceSettings {
  /// Candidate standard deviations of a disturbed term, as fractions of its prior standard deviation [-].
  std::vector<double> fractions = {0.1, 0.3};
  std::vector<double> time_constants = {5.0, 20.0};  ///< candidates [s]
  double white = 0.5;                                ///< prior weight of no slip disturbance [-]
  WeightingSettings weighting{.learning_rate = 1.0, .fraction = 0.01};
};

/// Where a segment is expected to end: what its sensors see, of a pose sensor the chart (x, y, theta) of T_start_end.
struct ExpectedPose {
  Rows pose;
  RowsCovariance covariance;
};

/// Where slip is at some time, under each candidate; empty where no term has a disturbance.
struct SlipNow {
  std::vector<SlipDeviation> of_candidates;
};

/// How far the disturbed terms are expected to be from what was learned, as the candidates mix.
struct ExpectedDeviation {
  std::vector<Eigen::Index> places;  ///< of their parameters
  Eigen::VectorXd mean;              ///< [places]
  Eigen::MatrixXd covariance;        ///< [places, places]
};

/// A prediction that follows the slip disturbance of the moment, and one that knows nothing recent of it.
struct ExpectedPoses {
  ExpectedPose now;
  ExpectedPose nominal;
};

/// Adds to the fractions of V and w in the slip rates a deviation that decays, follows it through the last segments,
/// and carries it into a prediction. How large and how slow the disturbance is is weighted among candidates by what
/// they predict; the first candidate is that it does not (derivations/uncertainty.md).
class DisturbanceFilter {
 public:
  /// \throws std::invalid_argument when a fraction or a time constant is not positive and finite.
  explicit DisturbanceFilter(const DisturbanceSettings& settings);
  DisturbanceFilter() = default;  ///< no slip disturbance
  /// As it was learned before, to predict with.
  /// \throws std::invalid_argument when the law's numbers contradict each other.
  explicit DisturbanceFilter(const DisturbanceModel& law);

  /// Weights the candidates by `segment`, predicted from `now`, which is as `predict` takes it.
  /// \throws std::invalid_argument when `now` comes from another law, or a model with other terms.
  void learn(const MotionPosterior& posterior, const SlipNow& now, const DrivenSegment& segment);
  /// What `recent` segments, in the order of time, say of the slip after them; without any, its nominal spread.
  SlipNow now(const MotionPosterior& posterior, std::span<const DrivenSegment> recent) const;
  /// Adds what one more segment says, which follows all that `now` comes from.
  /// \throws std::invalid_argument when `now` comes from another law, or a model with other terms.
  void follow(const MotionPosterior& posterior, SlipNow& now, const DrivenSegment& segment) const;
  /// The same of what `see` makes of the segment, under the posterior that `now` belongs to.
  static void follow(SlipNow& now, const ObservedSlip& seen);
  static ObservedSlip see(const MotionPosterior& posterior, const DrivenSegment& segment);
  /// Predicts `segment`, which starts no earlier than the last segment that `now` comes from ended.
  /// \throws std::invalid_argument when `now` comes from another law, or a model with other terms.
  ExpectedPose predict(const MotionPosterior& posterior, const SlipNow& now, const DrivenSegment& segment) const;
  /// The same of a segment that is linearised `at` the posterior's mean.
  ExpectedPose predict_at(const MotionPosterior& posterior, const SlipNow& now, const SegmentLinearization& at,
                          const Segment& segment) const;
  /// The same of a segment's beginnings, of which the last is all of it.
  std::vector<ExpectedPose> predict_along(const MotionPosterior& posterior, const SlipNow& now,
                                          std::span<const SegmentLinearization> beginnings,
                                          const Segment& segment) const;
  /// The same, and what is predicted where nothing recent is known.
  ExpectedPoses predict_both(const MotionPosterior& posterior, const SlipNow& now, const DrivenSegment& driven) const;

  /// How far slip is from what was learned, as a mean over the time `span` [s], which follows all of `now`.
  /// \throws std::invalid_argument when `now` comes from another law, or a model with other terms.
  ExpectedDeviation deviation(const MotionPosterior& posterior, const SlipNow& now,
                              const std::array<double, 2>& span) const;

  DisturbanceModel law() const { return {bank_.keys(), bank_.weights()}; }
  /// Begins with the weights of a law that was learned before; nothing changes where its candidates are others.
  void begin_with(const DisturbanceModel& law);

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.bank_, self.weighting_);
    check_disturbance(self.law());
  }

 private:
  ExpectedPose expected(const MotionPosterior& posterior, const SlipNow& now, const DisturbedTerms& terms,
                        const SegmentLinearization& at, const std::array<double, 2>& span) const;

  HypothesisBank<SlipDisturbance> bank_;
  WeightingSettings weighting_;
};

}  // namespace slipwise
