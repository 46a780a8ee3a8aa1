// SPDX-License-Identifier: Apache-2.0
// What becomes of measurements: segments to be learned or predicted, and what was rejected.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "slipwise/hypotheses/cascaded_model.hpp"
#include "slipwise/online/measurement.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/rejection.hpp"
#include "slipwise/segment/driven_segment.hpp"
#include "slipwise/segment/input_spread.hpp"

namespace slipwise {

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

/// In the order in which it is to be learned, and said.
struct StreamOutput {
  std::vector<StreamItem> items;
  std::vector<Rejected> rejected;

  void reject(Stream stream, Reason reason, double t) { rejected.push_back({stream, reason, t}); }
  void reject(const GatedPoses& gated) {
    for (const MeasuredPose& pose : gated.outliers) {
      reject(Stream::Pose, Reason::PoseOutlier, pose.t);
    }
    for (const MeasuredPose& pose : gated.jumps) {
      reject(Stream::Pose, Reason::PoseJump, pose.t);
    }
  }

  /// Names what is saved.
  template <class Self, class Archive>
  static void archive(Self& self, Archive& a) {
    a(self.items, self.rejected);
  }
};

}  // namespace slipwise
