// SPDX-License-Identifier: Apache-2.0
// Cuts a stream of poses into segments of a given length, each as soon after the last as poses and rules allow.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/pose_fix.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/position_fit.hpp"
#include "slipwise/online/rejection.hpp"
#include "slipwise/segment/segment.hpp"

namespace slipwise {

/// When two poses and the inputs between them make a segment.
struct SegmentRules {
  double late_factor = 2.5;        ///< a pose after a gap of more than this many median intervals is late: never an end
  double length_tolerance = 0.05;  ///< a segment may be this fraction longer or shorter than asked for
  double still_speed = 0.02;       ///< [m/s, rad/s] faster inputs never stand; slower ones may, beside those of the run
  double of_positions = 0.0;       ///< [s]; one between positions alone is so long, unless half of it tells as much
};

/// The median time between poses of late, taken again every 64 intervals.
class PoseInterval {
 public:
  void add(double seconds);
  /// [s]; 0 where there was none yet.
  double median() const { return median_; }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.recent_, self.count_, self.median_);
  }

 private:
  std::deque<double> recent_;
  std::size_t count_ = 0;
  double median_ = 0.0;
};

/// A pose as segments are cut from it.
struct TimedPose {
  MeasuredPose pose;      ///< its yaw unwrapped along its frame
  double interval = 0.0;  ///< median time between poses, as known then [s]
  double gap = 0.0;       ///< the longest time between poses since the last one that was not late [s]
};

/// Unwraps headings, and finds poses that are late by an unknown time.
class PoseTimer {
 public:
  /// The pose with the estimate of then; empty if it is late.
  std::optional<TimedPose> push(const MeasuredPose& pose, double late_factor);
  /// Another run begins; the intervals stay.
  void restart() { last_.reset(); }
  /// Median time between poses of late [s]; 0 where there were none.
  double interval() const { return interval_.median(); }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.interval_, self.last_, self.gap_);
  }

 private:
  PoseInterval interval_;
  std::optional<MeasuredPose> last_;
  double gap_ = 0.0;
};

/// Two poses between which a segment lies, or might have.
struct SegmentCut {
  MeasuredPose first;
  MeasuredPose second;
  std::optional<Reason> rejected;
  std::vector<MeasuredPose> positions = {};    ///< where only these are measured, from the first on, the last not
  std::optional<FittedPositions> fitted = {};  ///< what they tell

  /// T_first_second, the yaw difference along the unwrapped yaw.
  Pose2 measured() const;
};

/// Of the noise of both poses.
inline std::array<std::size_t, 2> classes_of(const SegmentCut& cut) {
  return {noise_class(cut.first.source, cut.first.fix), noise_class(cut.second.source, cut.second.fix)};
}

/// Walks along the poses of one run that are not late.
class SegmentCutter {
 public:
  SegmentCutter() = default;
  /// `length` is that of a segment [s]. Where `whole_frames`, a frame that is shorter is one segment. `stride` is the
  /// time between the starts of segments [s]; without one, each starts where the last ended.
  SegmentCutter(double length, SegmentRules rules, bool whole_frames, std::optional<double> stride = {});

  /// Takes a pose; `inputs` are known until its stamp. Returns the segments that it ends.
  std::vector<SegmentCut> push(const TimedPose& pose, const InputBuffer& inputs);
  /// No pose of the run follows.
  std::vector<SegmentCut> finish(const InputBuffer& inputs);
  /// By what positions of a segment scatter [m].
  void see_noise(double std) { noise_ += kNoiseGain * (std - noise_); }
  double length() const { return length_; }
  /// Stamp of the pose from which on the next segment may begin [s]; infinity where none came.
  double begins() const { return poses_.empty() ? std::numeric_limits<double>::infinity() : poses_.front().pose.t; }

  /// \throws std::invalid_argument where a loaded one cuts by other rules than `made`.
  void check_loaded(const SegmentCutter& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.length_, self.rules_, self.whole_frames_, self.stride_, self.poses_, self.any_, self.unknown_since_,
      self.noise_);
  }

 private:
  static constexpr double kNoiseGain = 0.2;

  void cut(double length, bool last, const InputBuffer& inputs, std::vector<SegmentCut>& out);
  /// The index of the first pose at `t` [s] or later.
  std::size_t first_from(double t) const;
  std::optional<std::size_t> nearest(double wanted, double tolerance, bool last) const;
  std::optional<Reason> problem(std::size_t end, const InputBuffer& inputs) const;
  std::size_t next_start(std::size_t end, std::optional<Reason> problem, const InputBuffer& inputs);
  void end_frame(const InputBuffer& inputs, std::vector<SegmentCut>& out);
  /// Of the next segment [s].
  double wanted() const;
  bool tells_enough(double length, const InputBuffer& inputs) const;
  std::vector<MeasuredPose> positions_until(std::size_t end) const;

  double length_ = 0.0;
  SegmentRules rules_;
  bool whole_frames_ = false;
  std::optional<double> stride_;
  std::deque<TimedPose> poses_;          ///< of the frame, from the next segment's start on
  bool any_ = false;                     ///< whether the frame lost poses at its beginning already
  std::optional<double> unknown_since_;  ///< the next segment starts once the input is known again
  double noise_ = 0.01;                  ///< of positions [m]
};

}  // namespace slipwise
