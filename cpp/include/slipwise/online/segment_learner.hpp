// SPDX-License-Identifier: Apache-2.0
// Learns what a stream makes of measurements, in that order and piece by piece, and says what was known when.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slipwise/hypotheses/motion_hypotheses.hpp"
#include "slipwise/online/held_out.hpp"
#include "slipwise/online/judged_targets.hpp"
#include "slipwise/online/known_sources.hpp"
#include "slipwise/online/learner_log.hpp"
#include "slipwise/online/learner_settings.hpp"
#include "slipwise/online/limit_evidence.hpp"
#include "slipwise/online/motion_leg.hpp"
#include "slipwise/online/recent_knowledge.hpp"
#include "slipwise/online/segment_stream.hpp"

namespace slipwise {

/// The stream that it learns from is handed to it each time. All stamps are counted by the clock of its log.
class SegmentLearner {
 public:
  explicit SegmentLearner(const LearnerSettings& settings);

  /// Another run begins; the one before has ended.
  void start_run();
  /// Nothing more comes of this run: all of it is learned.
  void end_run(const SegmentStream& stream);
  /// The clock was set again before a run: all was known by then.
  void restart_clock();
  /// Takes over what the stream has complete. What should have been learned by now is learned at once, so that results
  /// do not depend on how many pushes there were meanwhile.
  void take_in(SegmentStream& stream);
  /// Learns of what waits so that it is done evenly until it is due, where `passed` [s] lie between the stamps of
  /// pushes, and a bounded slice of refits.
  void work_evenly(const SegmentStream& stream, double passed);
  /// Learns all that was known at `t` [s], or all that waits.
  void work_until(const SegmentStream& stream, double t);
  void work_through(const SegmentStream& stream);

  /// Changes what is known beside segments; what waits was driven before, and is learned first.
  void change(const SegmentStream& stream,
              const std::function<void(MotionHypotheses&, const DisturbanceModel&)>& change);
  /// Another drive begins after the run before, which ended at `ended` [s].
  void start_drive(const DriveStart& start, std::size_t run, double ended);
  /// Begins with what another learner knew (`MotionHypotheses::begin_with`), and its slip disturbance.
  void begin_with(const SegmentStream& stream, const KnownBefore& known, const DisturbanceModel& law, bool wheels);
  /// Takes in what another learner remembers (`SurfaceBank::add`).
  std::vector<std::string> add_surfaces(const SegmentStream& stream, const KnownBefore& other);

  /// What was known of late; finding where slip was is kept for the next question.
  RecentKnowledge& known() { return known_; }
  const RecentKnowledge& known() const { return known_; }
  /// What predicts a leg at `t` [s], its errors as those over a `horizon` [s] were: by what was known a while before,
  /// so that it does not depend on how fast segments are learned.
  LegKnowledge for_leg(double t, double horizon);
  /// Where slip is after all that was measured, of a drive with these limits.
  SlipNow slip_at_newest(const SegmentStream& stream, const Knowledge& known, const CommandLimits& limits);
  /// The surfaces that are remembered, the present one as it is known now.
  SurfaceBank surfaces() const;
  /// Limits of the actuator, behind which what was driven of late is predicted better.
  std::optional<ActuatorLimits> find_limits(double wheel_separation) const;
  const MotionHypotheses& hypotheses() const { return hypotheses_; }
  const KnownSources& sources() const { return sources_; }
  const HeldOutErrors& errors() const { return errors_; }
  /// What was judged of late; nothing of a car, whose curves make its inputs.
  const JudgedTargets& targets() const { return targets_; }
  LearnerLog& log() { return log_; }
  const LearnerLog& log() const { return log_; }
  const LearnerSettings& settings() const { return settings_; }
  /// Of all segments learned [s].
  double seconds() const { return seconds_; }

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const SegmentLearner& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.hypotheses_, self.disturbance_, self.waiting_, self.started_, self.known_, self.limits_);
    a(self.errors_, self.log_, self.seconds_, self.sources_, self.targets_);
  }

 private:
  bool work(const SegmentStream& stream);
  bool learn_front(const SegmentStream& stream);
  void learn_source();
  void learn_disturbance(const DrivenSegment& segment);
  void publish(const DrivenSegment& segment, double wheel_interval);
  void consider_surfaces(double t);
  void note_surfaces(std::size_t run, double t);
  void note_change(std::size_t run, double t);
  std::vector<DrivenSegment> complete_now(const SegmentStream& stream) const;
  Knowledge now_known(double until) const;

  LearnerSettings settings_;
  MotionHypotheses hypotheses_;
  DisturbanceFilter disturbance_;
  std::deque<StreamItem> waiting_;  ///< in the order in which it is learned
  bool started_ = false;            ///< whether the first of it is being learned
  RecentKnowledge known_;
  LimitEvidence limits_;
  HeldOutErrors errors_;
  JudgedTargets targets_;
  LearnerLog log_;
  double seconds_ = 0.0;
  KnownSources sources_;  ///< where there are several, or fixes
};

}  // namespace slipwise
