// SPDX-License-Identifier: Apache-2.0
// From poses of the first source, and wheel speeds, to segments: those to be learned, and those to be predicted.
#pragma once

#include <vector>

#include "slipwise/online/measured_drive.hpp"
#include "slipwise/online/pose_twists.hpp"
#include "slipwise/online/segment_cutter.hpp"
#include "slipwise/online/stream_output.hpp"
#include "slipwise/online/stream_settings.hpp"

namespace slipwise {

/// Cuts the same poses for all that is learned of them. Once wheel speeds were known, slip behind commands is learned
/// from segments behind these.
class SegmentCutters {
 public:
  explicit SegmentCutters(const StreamSettings& settings);

  /// A pose that was accepted, used at `now` [s].
  void push(const TimedPose& timed, const MeasuredDrive& drive, bool wheels_known, double now, StreamOutput& out);
  /// A wheel speed's stamp: these end segments of their own, from which the actuator model is learned.
  void push_wheels(const TimedPose& timed, const MeasuredDrive& drive, StreamOutput& out);
  /// Nothing of this run follows: what is to be learned, and what is to be predicted.
  void finish(const MeasuredDrive& drive, bool wheels_known, double now, StreamOutput& out);
  void finish_targets(const MeasuredDrive& drive, double now, StreamOutput& out);
  /// From when on inputs are needed [s], where nothing else needs them from before `begun` on.
  double begins(double begun) const;
  const SegmentCutter& learned() const { return learned_; }

  /// \throws std::invalid_argument where loaded ones are none that `made`, of the same settings, could have become.
  void check_loaded(const SegmentCutters& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.learned_, self.slip_, self.wheels_, self.twists_, self.targets_);
  }

 private:
  SegmentCutter learned_;
  SegmentCutter slip_;
  SegmentCutter wheels_;
  PoseTwists twists_;
  std::vector<SegmentCutter> targets_;
};

}  // namespace slipwise
