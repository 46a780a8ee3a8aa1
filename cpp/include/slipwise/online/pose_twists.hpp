// SPDX-License-Identifier: Apache-2.0
// How fast a robot moved between its poses: where no wheel speeds come, limits of the actuator show in these.
#pragma once

#include <optional>
#include <vector>

#include "slipwise/lie/body_twist.hpp"
#include "slipwise/lie/se2.hpp"
#include "slipwise/online/input_buffer.hpp"
#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {

/// Twists between poses one after another, without a gap.
struct TwistStretch {
  double start = 0.0;                 ///< [s]
  double end = 0.0;                   ///< [s]
  std::vector<double> t = {};         ///< [N] s, in the middle between two poses
  std::vector<BodyTwist> twist = {};  ///< [N] of base_link
};

/// Takes the poses of one run after another. Poses that are too rare to tell a slow actuator from one with limits give
/// no twists.
class PoseTwists {
 public:
  /// `sensor` is where the pose sensor sits in base_link.
  PoseTwists(const SegmentRules& rules, const Pose2& sensor);

  /// Takes a pose that is not late; `commands` are known until its stamp. Returns the stretches that it ends.
  std::vector<TwistStretch> push(const TimedPose& pose, const InputBuffer& commands);
  /// No pose of the run follows.
  std::vector<TwistStretch> finish(const InputBuffer& commands);
  /// From which stamp on commands are needed [s]; infinity where there is no need.
  double begins() const;

  /// \throws std::invalid_argument where a loaded one cuts by other rules than `made`.
  void check_loaded(const PoseTwists& made) const;

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.sensor_, self.cutter_, self.stretch_);
  }

 private:
  std::vector<TwistStretch> joined(const std::vector<SegmentCut>& cuts);
  void close(std::vector<TwistStretch>& out);

  Pose2 sensor_;
  SegmentCutter cutter_;
  std::optional<TwistStretch> stretch_;  ///< that grows
};

}  // namespace slipwise
