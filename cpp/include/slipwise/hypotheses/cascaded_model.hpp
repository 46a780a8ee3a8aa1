// SPDX-License-Identifier: Apache-2.0
// Learning from commands in two parts: the actuator model from wheel speeds, and the slip behind it from poses.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slipwise/filter/motion_posterior.hpp"
#include "slipwise/filter/predictive_score.hpp"
#include "slipwise/hypotheses/estimate_history.hpp"
#include "slipwise/hypotheses/remembering_average.hpp"
#include "slipwise/identify/actuator_filter.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// A stretch of commands and of the wheel speeds that follow them.
struct WheelSegment {
  InputHistory commands;
  InputHistory wheels;
  double start;           ///< [s] in input stamps
  double end;             ///< [s]
  double known_at = end;  ///< [s] when the last of it was measured
};

/// Wheel speeds are what the actuator gives out and what the slip acts on: each part is learned from much more than the
/// joint model has.
class CascadedModel {
 public:
  CascadedModel();
  /// `slip` has learned nothing yet; its inputs are wheel speeds. With a wheelbase [m] the commands steer.
  CascadedModel(RememberingAverage slip, const CausalFilterSettings& settings, double wheelbase = 0.0);

  /// Begins to learn the slip from a segment whose inputs are wheel speeds; `advance_slip` does a piece of it, and says
  /// whether there is more.
  void start_slip(const DrivenSegment& segment);
  bool advance_slip();
  /// Does a bounded slice of the refits; whether there was any to do.
  bool refit_slice() { return actuator_.refit_slice() || slip_.average().refit_slice(); }
  /// Learns the actuator model from commands and wheel speeds.
  void learn_actuator(const WheelSegment& segment);
  /// Begins with an actuator that was learned before.
  void begin_with(const Estimate& actuator, const CausalFilterSettings& settings);
  const MotionModel& actuator_model() const { return actuator_.model(); }
  /// Stamps begin again, or the slip is that of another ground: what is known now was known before.
  void restart();
  /// Predicts a segment of the commands by what was known when it started, however much was learned meanwhile. Segments
  /// come in the order of their starts.
  ScoredSegment predict(const DrivenSegment& segment);
  /// Joins the estimates of slip and actuator.
  void refresh();
  /// What was joined last.
  const std::shared_ptr<const MotionPosterior>& posterior() const { return posterior_; }
  /// The strongest test for a change of terrain since the last `refresh`.
  const SlipChange& change() const { return change_; }
  /// Whether a refit of the slip took effect since the last `refresh` but one.
  bool refitted() const { return refitted_; }
  /// What learns the slip.
  RememberingAverage& slip() { return slip_; }
  const RememberingAverage& slip() const { return slip_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const CascadedModel& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.model_, self.noise_, self.slip_, self.actuator_, self.score_, self.places_of_slip_, self.places_of_actuator_,
      self.known_slip_);
    a(self.known_actuator_, self.slip_until_, self.change_, self.change_since_, self.refitted_, self.refitted_since_,
      self.posterior_);
  }

 private:
  Estimate joined(const Estimate& slip, const Estimate& actuator) const;

  MotionModel model_;
  MotionNoise noise_;
  RememberingAverage slip_;
  ActuatorFilter actuator_;
  PredictiveScore score_;
  std::vector<Eigen::Index> places_of_slip_;  ///< of its parameters among the model's
  std::vector<Eigen::Index> places_of_actuator_;
  EstimateHistory known_slip_;
  EstimateHistory known_actuator_;
  double slip_until_ = 0.0;  ///< [s] end of the segment that the slip is learned from now
  SlipChange change_;
  SlipChange change_since_;
  bool refitted_ = false;
  bool refitted_since_ = false;
  std::shared_ptr<const MotionPosterior> posterior_;
};

}  // namespace slipwise
