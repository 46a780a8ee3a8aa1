// SPDX-License-Identifier: Apache-2.0
// From measurements as they arrive to segments that can be learned: ordered, cleaned, bounded.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "slipwise/hypotheses/cascaded_model.hpp"
#include "slipwise/online/attitude_gate.hpp"
#include "slipwise/online/body_rates.hpp"
#include "slipwise/online/car_stream.hpp"
#include "slipwise/online/course_finder.hpp"
#include "slipwise/online/force_buffer.hpp"
#include "slipwise/online/hold_times.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/learner_times.hpp"
#include "slipwise/online/measurement.hpp"
#include "slipwise/online/motion_evidence.hpp"
#include "slipwise/online/pose_accuracy.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/pose_source.hpp"
#include "slipwise/online/pose_twists.hpp"
#include "slipwise/online/readings.hpp"
#include "slipwise/online/rejection.hpp"
#include "slipwise/online/sample_gate.hpp"
#include "slipwise/online/segment_cutter.hpp"
#include "slipwise/online/tilt_buffer.hpp"
#include "slipwise/segment/driven_segment.hpp"

namespace slipwise {

/// How measurements become segments.
struct StreamSettings {
  bool from_commands = true;          ///< motion is predicted from commands; otherwise from wheel speeds
  double segment_length = 2.5;        ///< of a learned stretch [s]
  bool whole_frames = true;           ///< a frame that is shorter is learned as one segment
  std::optional<double> stride = {};  ///< time between the starts of segments [s]; without one they are disjoint
  SegmentRules rules = {};
  double unknown_after = 0.5;                      ///< an input is unknown once it is older than this [s]
  double latency = 0.5;                            ///< streams may be late relative to each other by up to this [s]
  std::vector<double> horizons = {1.0, 2.0, 5.0};  ///< of the predictions that are held against what was measured [s]
  /// The predictions use parameters as they were known so long before their start [s]; without it, a horizon before.
  std::optional<double> embargo = {};
  Pose2 sensor = {};                 ///< where the pose sensor is known to sit in base_link
  std::optional<CarPrior> car = {};  ///< commands are throttle (v) and steering (omega) of a car
  bool heading_only = false;         ///< no poses come: turns of a gyro alone are learned from
  /// Of all sources of poses, where there are several or their fixes count; the first is sources[0].
  std::vector<SourceSettings> sources = {};

  /// From what is known until a prediction over `horizon` [s] starts.
  double age_of_known(double horizon) const { return std::max(embargo.value_or(horizon), kReady); }
};

/// A segment whose prediction is held against what was measured.
struct TargetSegment {
  std::size_t horizon;  ///< among the settings'
  DrivenSegment driven;
  std::optional<InputHistory> baseline = {};  ///< what the kinematic baseline does, where it is not the inputs
  std::array<std::size_t, 2> classes = {};    ///< of the noise of its poses, where sources are distinguished
  InputSpread spread = {};                    ///< how the inputs may be else, where a car's curves make them
};

/// A segment between poses of one of several sources: it is learned where no better one covers the time.
struct SourceSegment {
  DrivenSegment driven;
  std::size_t source;
  std::array<std::size_t, 2> classes;  ///< of the noise of its poses
};

/// A segment from which slip is learned behind measured wheel speeds.
struct SlipSegment {
  DrivenSegment driven;
};

/// Commands, and twists between poses that followed them, where no wheel speeds come.
struct TwistSegment {
  WheelSegment driven;
};

/// Something rejected.
struct Rejected {
  Stream stream;
  Reason reason;
  double t;  ///< [s]
};

using StreamItem = std::variant<WheelSegment, SlipSegment, TwistSegment, DrivenSegment, TargetSegment, SourceSegment>;

/// Takes measurements of one run after another. Streams are in order each, and late relative to each other by no more
/// than the latency: a pose is used once no earlier measurement can arrive, so that what comes out does not depend on
/// how they interleave. Memory does not grow with time.
class SegmentStream {
 public:
  explicit SegmentStream(const StreamSettings& settings);
  SegmentStream(const SegmentStream&);
  SegmentStream(SegmentStream&&) noexcept;
  SegmentStream& operator=(const SegmentStream&);
  SegmentStream& operator=(SegmentStream&&) noexcept;
  ~SegmentStream();

  /// The run so far is complete, and another begins. Nothing is joined across runs.
  void start_run();
  /// No measurement of this run follows.
  void end_run();
  /// Takes a measurement; whether it may be used. Otherwise it is rejected.
  bool push(const Measurement& measurement);

  /// What became complete since the last call, in the order in which it is to be learned.
  std::vector<StreamItem> take_items();
  std::vector<Rejected> take_rejected();

  /// The newest stamp of the run [s]; minus infinity before the first.
  double newest() const { return newest_; }
  const InputBuffer& commands() const { return commands_; }
  const GyroBuffer& gyro() const { return readings_.gyro(); }
  const AttitudeGate& attitudes() const { return attitudes_; }
  const InputBuffer& wheels() const { return wheels_; }
  const StreamSettings& settings() const { return settings_; }
  /// Stamps are counted from `origin` [s] from now on, which matters to messages alone.
  void count_from(double origin) { evidence_.count_from(origin); }
  /// What shows whether poses and inputs contradict each other.
  const MotionEvidence& evidence() const { return evidence_; }
  bool wheels_known() const { return wheels_ever_; }
  /// Greatest roll or pitch [rad], of all runs.
  double steepest() const { return steepest_; }
  /// Least and greatest speed, then yaw rate, of the inputs that motion is predicted from, of all runs.
  const std::array<double, 4>& range() const { return range_; }
  /// What the poses show of the body's rates, of all runs.
  MeasuredRates rates() const { return rates_.found(); }
  /// For how long the inputs that motion is predicted from were held, of all runs: speed, yaw rate [s].
  std::array<double, 2> held() const { return held_.found(); }
  /// Median time between wheel speeds of late [s]; 0 where there were none.
  double wheel_interval() const { return wheel_timer_.interval(); }

  /// The segments that are complete with all that was pushed, were nothing late.
  std::vector<DrivenSegment> pending_segments() const;
  /// The segment from now on over `horizon` [s], driven by `future` inputs. What is held for longer than any input that
  /// was measured is repeated, so that there are poses on the way.
  DrivenSegment segment_ahead(double horizon, const std::vector<InputSample>& future) const;
  /// Known forces over what lies ahead: those of late, and then the `future` ones.
  /// \throws std::invalid_argument when one is impossible, or attitudes say that the ground is not level.
  ForceBuffer forces_ahead(const std::vector<KnownForce>& future) const;
  /// How the inputs of `segment_ahead` may be else, where a car's curves make them of the commands.
  InputSpread spread_ahead(double horizon, const std::vector<InputSample>& future) const;

  /// The motion over [start, end] [s] with the inputs that came so far, those of the last `back` [s] before it
  /// included.
  DrivenSegment stretch(double start, double end, double back) const;
  /// What motion is predicted from.
  const InputBuffer& inputs() const { return settings_.from_commands ? commands_ : wheels_; }
  /// What throttle and steering do, where they are the commands.
  std::optional<CarCurves> car_curves() const;

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const SegmentStream& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.settings_, self.keep_, self.newest_, self.stamps_, self.speeds_, self.commands_, self.wheels_,
      self.wheels_ever_, self.range_, self.rates_, self.held_);
    a(self.tilts_, self.poses_, self.wheel_stamps_, self.now_, self.accuracy_, self.gate_, self.timer_,
      self.wheel_timer_, self.learned_, self.slip_);
    a(self.car_, self.wheel_cutter_, self.twists_, self.targets_, self.items_, self.rejected_, self.breaks_,
      self.learned_last_);
    a(self.courses_, self.position_last_, self.readings_, self.heading_, self.others_, self.turned_until_, self.turned_,
      self.attitudes_, self.evidence_, self.forces_, self.steepest_);
  }

 private:
  bool take(const CommandSample& command);
  bool take(const WheelSample& wheels);
  /// By REP-103 nose down is positive pitch.
  bool take(const Tilt& measured);
  /// Beside attitudes it is rejected.
  bool take(const KnownForce& force);
  bool take(const Reading& reading);
  /// No segment lies between a pose and what is a position alone.
  bool take(const MeasuredPose& pose);
  bool arrives(Stream stream, double t, std::span<const double> numbers, std::size_t kind = 0);
  bool take_input(Stream stream, const InputSample& sample);
  void advance(double until);
  void process_wheels(double until);
  void process_pose(const MeasuredPose& raw);
  void turn_on(const TimedNumber& sample);
  bool take_first(const MeasuredPose& pose);
  bool take_other(MeasuredPose pose);
  void begin_others();
  void finish_others();
  void advance_others(double until);
  void process_other(PoseSource& source, const GatedPoses& gated, double known_at);
  void emit_other(const PoseSource& source, const SegmentCut& cut, double known_at);
  void process_accepted(const GatedPoses& gated);
  void reject_gated(const GatedPoses& gated);
  bool head(TimedPose& timed, CourseFinder& courses) const;
  std::vector<SegmentCut> fitted(std::vector<SegmentCut> cuts, const Pose2& place) const;
  void emit_learned(const std::vector<SegmentCut>& cuts);
  void emit_slip(const std::vector<SegmentCut>& cuts);
  void emit_twists(const std::vector<TwistStretch>& stretches);
  void emit_targets(std::size_t horizon, const std::vector<SegmentCut>& cuts);
  void emit_wheel_segments(const std::vector<SegmentCut>& cuts);
  void finish_cutters();
  void trim();
  const InputBuffer& gate_inputs(double t) const;
  std::vector<InputSample> repeated(const std::vector<InputSample>& future, double end) const;
  DrivenSegment driven(const SegmentCut& cut, bool by_wheels, double known_at,
                       std::optional<double> horizon = std::nullopt) const;
  /// What commands ask for over [start, end] and `back` [s] before, by what was known of a car at `known` [s].
  InputHistory commanded(const Segment& over, double back, double known,
                         const std::vector<InputSample>& future = {}) const;
  InputHistory wheels(double start, double end) const;
  const InputBuffer& given() const { return car_ && settings_.from_commands ? car_->given() : inputs(); }
  void set_actuator_state(Segment& segment) const;
  void set_turn(Segment& segment) const;
  MeasuredPose complete(const MeasuredPose& raw, PoseAccuracies& accuracies) const;
  void stand_on_ground(Segment& segment, bool foreseen) const;
  void reject(Stream stream, Reason reason, double t) { rejected_.push_back({stream, reason, t}); }

  StreamSettings settings_;
  double keep_;  ///< how long inputs are kept [s]
  double newest_;
  std::array<StampGate, kStreams - 1 + kReadingKinds> stamps_;  ///< of each kind of readings, which come last
  std::array<std::array<SpeedGate, 3>, 2> speeds_;
  InputBuffer commands_;
  InputBuffer wheels_;
  bool wheels_ever_ = false;
  std::array<double, 4> range_;
  AttitudeGate attitudes_;
  double steepest_ = 0.0;
  BodyRates rates_;
  HoldTimes held_;
  TiltBuffer tilts_;
  ForceBuffer forces_;
  std::deque<MeasuredPose> poses_;   ///< not used yet
  std::deque<double> wheel_stamps_;  ///< not used yet
  double now_;                       ///< stamp of the pose that is being used, or was last [s]
  PoseAccuracies accuracy_;          ///< by fix
  PoseGate gate_;
  PoseTimer timer_;
  PoseTimer wheel_timer_;
  SegmentCutter learned_;
  SegmentCutter slip_;
  SegmentCutter wheel_cutter_;
  PoseTwists twists_;
  std::vector<SegmentCutter> targets_;
  std::optional<CarStream> car_;  ///< where commands are throttle and steering
  std::vector<StreamItem> items_;
  std::vector<Rejected> rejected_;
  long breaks_ = 0;           ///< times that poses were not learned from
  bool learned_last_ = true;  ///< whether the last pose was
  CourseFinder courses_;
  Readings readings_;
  bool position_last_ = false;               ///< whether the last pose was a position alone
  double heading_ = 0.0;                     ///< of the last pose that was accepted [rad]
  std::vector<PoseSource> others_;           ///< sources of poses beside the first
  std::optional<TimedNumber> turned_until_;  ///< the last yaw rate, where these alone are learned from
  double turned_ = 0.0;                      ///< integral of yaw rates [rad]
  MotionEvidence evidence_;
};

}  // namespace slipwise
