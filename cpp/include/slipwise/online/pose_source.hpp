// SPDX-License-Identifier: Apache-2.0
// One of several sources of poses: where it sits, how late it is, and its way from poses to segments.
#pragma once

#include <array>
#include <deque>
#include <limits>
#include <optional>

#include "slipwise/lie/se2.hpp"
#include "slipwise/online/pose_accuracy.hpp"
#include "slipwise/online/pose_fix.hpp"
#include "slipwise/online/pose_gate.hpp"
#include "slipwise/online/rejection.hpp"
#include "slipwise/online/segment_cutter.hpp"

namespace slipwise {

/// Settings of a source before it measures. The first source's values are learned as the model's own.
struct SourceSettings {
  Pose2 sensor = {};            ///< where it sits in base_link, as far as that is known
  double late = 0.0;            ///< seconds that its stamps are known to be late
  double clock_std = 0.2;       ///< what adds to that is learned about 0 [s]; 0 where it is not learned
  double sensor_std_xy = 0.0;   ///< the same of where it sits [m]
  double sensor_std_yaw = 0.0;  ///< [rad]
  double poorest = 20.0;        ///< errors this many times as large as the first's teach nothing [-]
};

using PoseAccuracies = std::array<PoseAccuracy, kPoseFixes>;

/// How much later than its stamp a pose of another source may have been measured, or earlier [s].
inline constexpr double kClocksApart = 0.5;

/// A source beside the first. Its poses may come out of order, and late by the latency of the stream.
struct PoseSource {
  SourceSettings settings;
  SegmentCutter cutter;
  PoseGate gate = {};
  PoseTimer timer = {};
  PoseAccuracies accuracies = {};
  std::deque<MeasuredPose> waiting = {};                   ///< not used yet, in the order of their stamps
  double used = -std::numeric_limits<double>::infinity();  ///< stamp of the last that was [s]
  long breaks = 0;                                         ///< times that what comes is not comparable with what came
  bool position_last = false;

  /// Takes a pose between those that wait; why not, if it cannot.
  std::optional<Reason> take(const MeasuredPose& pose);
  /// Another run begins.
  void restart();
};

}  // namespace slipwise
