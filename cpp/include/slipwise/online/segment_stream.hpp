// SPDX-License-Identifier: Apache-2.0
// From measurements as they arrive to segments that can be learned: ordered, cleaned, bounded.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "slipwise/linear/same_stamp.hpp"
#include "slipwise/online/attitude_gate.hpp"
#include "slipwise/online/course_finder.hpp"
#include "slipwise/online/driven_range.hpp"
#include "slipwise/online/measured_drive.hpp"
#include "slipwise/online/measurement.hpp"
#include "slipwise/online/motion_evidence.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/pose_sources.hpp"
#include "slipwise/online/sample_gate.hpp"
#include "slipwise/online/segment_cutters.hpp"
#include "slipwise/online/stream_output.hpp"
#include "slipwise/online/stream_settings.hpp"

namespace slipwise {

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
  const AttitudeGate& attitudes() const { return attitudes_; }
  const StreamSettings& settings() const { return drive_.settings; }
  /// What was measured of late beside poses.
  const MeasuredDrive& drive() const { return drive_; }
  /// Stamps are counted from `origin` [s] from now on, which matters to messages alone.
  void count_from(double origin) { evidence_.count_from(origin); }
  /// What shows whether poses and inputs contradict each other.
  const MotionEvidence& evidence() const { return evidence_; }
  bool wheels_known() const { return wheels_ever_; }
  /// What was driven in all runs.
  const DrivenRange& range() const { return range_; }
  /// Median time between wheel speeds of late [s]; 0 where there were none.
  double wheel_interval() const { return wheel_timer_.interval(); }

  /// The segments that are complete with all that was pushed, were nothing late.
  std::vector<DrivenSegment> pending_segments() const;
  /// Over [start, end] [s], with the heading of the last pose that was accepted: to be driven.
  Segment over(double start, double end) const;

  /// \throws std::invalid_argument where a loaded one is none that `made`, of the same settings, could have become.
  void check_loaded(const SegmentStream& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.drive_, self.keep_, self.newest_, self.stamps_, self.speeds_, self.wheels_ever_, self.range_);
    a(self.poses_, self.wheel_stamps_, self.now_, self.accuracy_, self.gate_, self.timer_, self.wheel_timer_,
      self.cutters_, self.output_, self.breaks_, self.learned_last_);
    a(self.courses_, self.position_last_, self.heading_, self.others_, self.turned_until_, self.turned_,
      self.attitudes_, self.evidence_);
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
  bool take_input(Stream stream, const InputSample& sample, const BodyTwist& given);
  void advance(double until);
  void process_wheels(double until);
  void process_pose(const MeasuredPose& raw);
  void turn_on(const TimedNumber& sample);
  bool take_first(const MeasuredPose& pose);
  void process_accepted(const GatedPoses& gated);
  bool head(TimedPose& timed, CourseFinder& courses) const;
  void trim();

  MeasuredDrive drive_;
  double keep_;  ///< how long inputs are kept [s]
  double newest_ = -kNever;
  std::array<StampGate, kStreams - 1 + kReadingKinds> stamps_;  ///< of each kind of readings, which come last
  std::array<std::array<SpeedGate, 3>, 2> speeds_;
  bool wheels_ever_ = false;
  DrivenRange range_;
  AttitudeGate attitudes_;
  std::deque<MeasuredPose> poses_;   ///< not used yet
  std::deque<double> wheel_stamps_;  ///< not used yet
  double now_ = -kNever;             ///< stamp of the pose that is being used, or was last [s]
  PoseAccuracies accuracy_;          ///< by fix
  PoseGate gate_;
  PoseTimer timer_;
  PoseTimer wheel_timer_;
  SegmentCutters cutters_;
  long breaks_ = 0;           ///< times that poses were not learned from
  bool learned_last_ = true;  ///< whether the last pose was
  CourseFinder courses_;
  bool position_last_ = false;               ///< whether the last pose was a position alone
  double heading_ = 0.0;                     ///< of the last pose that was accepted [rad]
  std::optional<TimedNumber> turned_until_;  ///< the last yaw rate, where these alone are learned from
  double turned_ = 0.0;                      ///< integral of yaw rates [rad]
  PoseSources others_;                       ///< beside the first
  StreamOutput output_;
  MotionEvidence evidence_;
};

}  // namespace slipwise
